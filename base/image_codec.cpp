// PNG (W3C, 2003), JPEG (ITU-T T.81, Annex B), BMP (BITMAPINFOHEADER), WebP (RFC 9649), TIFF 6.0.

#include "base/image_codec.h"

#include <png.h>
#include <zlib.h>
#include <algorithm>
#include <cassert>
#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "base/input_error.h"
#include "base/mapped_file.h"

#ifdef FOCI_COMPRESSION
#include <turbojpeg.h>
#include <webp/decode.h>
#endif

namespace foci {
namespace {

constexpr int kChannels = 4;

void keepSilent(png_structp, png_const_charp) {}

/// @return false if the image's size is not usable
bool allocate(DecodedImage& image, std::uint64_t max_pixels) {
  if (image.columns <= 0 || image.rows <= 0 || image.total() > max_pixels) return false;
  image.rgba.resize(kChannels * image.total());
  return true;
}

/// libpng leaves its functions by `longjmp`: what they change stands in members, not in locals.
class PngReader {
 public:
  explicit PngReader(std::span<const unsigned char> bytes)
      : left_(bytes),
        png_(png_create_read_struct(
            PNG_LIBPNG_VER_STRING, nullptr,
            [](png_structp png, png_const_charp) { png_longjmp(png, 1); }, keepSilent)),
        info_(png_create_info_struct(png_)) {}
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader& operator=(PngReader&&) = delete;  // nor copied

  bool read(std::uint64_t max_pixels) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, [](png_structp png, png_bytep to, std::size_t count) {
      auto& left = static_cast<PngReader*>(png_get_io_ptr(png))->left_;
      if (count > left.size()) png_error(png, "too short");
      std::copy_n(left.data(), count, to);
      left = left.subspan(count);
    });
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    image.columns = static_cast<int>(png_get_image_width(png_, info_));
    image.rows = static_cast<int>(png_get_image_height(png_, info_));
    if (!allocate(image, max_pixels)) return false;
    rows_.resize(static_cast<std::size_t>(image.rows));
    for (std::size_t y = 0; y < rows_.size(); ++y) {
      rows_[y] = image.rgba.data() + kChannels * y * static_cast<std::size_t>(image.columns);
    }
    png_read_image(png_, rows_.data());
    return true;
  }

  DecodedImage image{};

 private:
  std::span<const unsigned char> left_;
  std::vector<png_bytep> rows_{};
  png_structp png_;
  png_infop info_;
};

#ifdef FOCI_COMPRESSION
using TurboJpeg = std::unique_ptr<void, decltype([](void* handle) { tjDestroy(handle); })>;

/// The inks of a JPEG for print, as Adobe writes them: inverted.
void rgbaOfInks(std::vector<std::uint8_t>& pixels) {
  for (std::size_t i = 0; i < pixels.size(); i += kChannels) {
    const int black = pixels[i + 3];
    for (std::size_t k = i; k < i + 3; ++k) {
      pixels[k] = static_cast<std::uint8_t>((pixels[k] * black + 127) / 255);
    }
    pixels[i + 3] = 255;
  }
}

std::optional<DecodedImage> decodeJpeg(std::span<const unsigned char> bytes,
                                       std::uint64_t max_pixels) {
  const TurboJpeg handle(tjInitDecompress());
  DecodedImage image;
  int subsampling = 0, colors = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(handle.get(), bytes.data(), size, &image.columns, &image.rows,
                          &subsampling, &colors) != 0 ||
      !allocate(image, max_pixels)) {
    return std::nullopt;
  }
  const bool inks = colors == TJCS_CMYK || colors == TJCS_YCCK;
  if (tjDecompress2(handle.get(), bytes.data(), size, image.rgba.data(), image.columns, 0,
                    image.rows, inks ? TJPF_CMYK : TJPF_RGBA, 0) != 0 &&
      tjGetErrorCode(handle.get()) != TJERR_WARNING) {
    return std::nullopt;
  }
  if (inks) rgbaOfInks(image.rgba);
  return image;
}

std::optional<DecodedImage> decodeWebp(std::span<const unsigned char> bytes,
                                       std::uint64_t max_pixels) {
  WebPBitstreamFeatures stated;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &stated) != VP8_STATUS_OK) return std::nullopt;
  DecodedImage image{.columns = stated.width, .rows = stated.height};
  if (!allocate(image, max_pixels)) return std::nullopt;
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(),
                         kChannels * image.columns) == nullptr) {
    return std::nullopt;
  }
  return image;
}
#endif

}  // namespace

std::optional<DecodedImage> decodeImage(std::span<const unsigned char> bytes,
                                        std::uint64_t max_pixels) {
  if (bytes.size() < 12) return std::nullopt;
  if (png_sig_cmp(bytes.data(), 0, 8) == 0) {
    PngReader reader(bytes);
    if (!reader.read(max_pixels)) return std::nullopt;
    return std::move(reader.image);
  }
#ifdef FOCI_COMPRESSION
  if (bytes[0] == 0xff && bytes[1] == 0xd8) return decodeJpeg(bytes, max_pixels);
  if (auto webp = decodeWebp(bytes, max_pixels)) return webp;
#endif
  return decodeTarga(bytes, max_pixels);
}

std::vector<std::uint8_t> encodePng(int columns, int rows, int channels,
                                    const std::uint8_t* pixels) {
  assert(channels == 1 || channels == 3);
  std::vector<std::uint8_t> bytes;
  // Only memory can fail here: the error is thrown through libpng, which holds nothing else.
  png_structp png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, nullptr,
      [](png_structp, png_const_charp why) { throw std::runtime_error(why); }, keepSilent);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp to, png_bytep from, std::size_t count) {
        auto& all = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(to));
        all.insert(all.end(), from, from + count);
      },
      nullptr);
  // Fast to write, and small for what is rendered.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_level(png, Z_BEST_SPEED);
  png_set_compression_strategy(png, Z_RLE);
  png_set_IHDR(png, info, static_cast<png_uint_32>(columns), static_cast<png_uint_32>(rows), 8,
               channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  png_write_info(png, info);
  for (int y = 0; y < rows; ++y) {
    png_write_row(png, pixels + static_cast<std::size_t>(y) * columns * channels);
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

#ifdef FOCI_COMPRESSION
std::vector<std::uint8_t> encodeJpeg(int columns, int rows, const std::uint8_t* rgb, int quality) {
  const TurboJpeg handle(tjInitCompress());
  unsigned char* to = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(handle.get(), rgb, columns, 0, rows, TJPF_RGB, &to, &size,
                                 TJSAMP_420, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, decltype([](unsigned char* p) { tjFree(p); })> keeper(to);
  if (failed != 0) throw std::runtime_error(tjGetErrorStr2(handle.get()));
  return {to, to + size};
}
#else
std::vector<std::uint8_t> encodeJpeg(int, int, const std::uint8_t*, int) {
  throw std::runtime_error("foci was built without JPEG");
}
#endif

namespace {

using Bytes = std::span<const unsigned char>;

bool hasText(Bytes bytes, std::size_t at, std::string_view text) {
  if (bytes.size() < at + text.size()) return false;
  return std::string_view(reinterpret_cast<const char*>(bytes.data()) + at, text.size()) == text;
}

std::uint64_t big(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::uint64_t little(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i > 0; --i) value = value << 8 | bytes[at + i - 1];
  return value;
}

/// Walks over the segments to the frame header: SOF0 to SOF15 without DHT, JPG and DAC.
std::optional<ImageSize> jpegSize(Bytes bytes) {
  for (std::size_t at = 2; at + 9 <= bytes.size();) {
    if (bytes[at] != 0xff) return std::nullopt;
    const unsigned char marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return ImageSize{big(bytes, at + 7, 2), big(bytes, at + 5, 2)};
    at += 2 + static_cast<std::size_t>(big(bytes, at + 2, 2));
  }
  return std::nullopt;
}

std::optional<ImageSize> bmpSize(Bytes bytes) {
  if (bytes.size() < 26 || little(bytes, 14, 4) < 40) return std::nullopt;
  // A negative number of rows: the first one is on top.
  const auto rows = static_cast<std::int32_t>(little(bytes, 22, 4));
  return ImageSize{little(bytes, 18, 4), static_cast<std::uint64_t>(std::abs(std::int64_t{rows}))};
}

std::optional<ImageSize> webpSize(Bytes bytes) {
  if (bytes.size() < 30) return std::nullopt;
  if (hasText(bytes, 12, "VP8X"))
    return ImageSize{little(bytes, 24, 3) + 1, little(bytes, 27, 3) + 1};
  if (hasText(bytes, 12, "VP8 ")) {
    return ImageSize{little(bytes, 26, 2) & 0x3fff, little(bytes, 28, 2) & 0x3fff};
  }
  if (!hasText(bytes, 12, "VP8L")) return std::nullopt;
  const std::uint64_t bits = little(bytes, 21, 4);
  return ImageSize{(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
}

/// Of the first directory.
std::optional<ImageSize> tiffSize(Bytes bytes) {
  constexpr std::uint64_t kColumns = 256, kRows = 257, kShort = 3;
  const auto number = [&](std::size_t at, std::size_t count) {
    return bytes[0] == 'I' ? little(bytes, at, count) : big(bytes, at, count);
  };
  if (bytes.size() < 8) return std::nullopt;
  const std::size_t begin = number(4, 4);
  if (begin + 2 > bytes.size()) return std::nullopt;
  ImageSize size;
  const std::size_t end = begin + 2 + 12 * number(begin, 2);
  for (std::size_t at = begin + 2; at + 12 <= std::min(end, bytes.size()); at += 12) {
    const std::uint64_t value = number(at + 8, number(at + 2, 2) == kShort ? 2 : 4);
    if (number(at, 2) == kColumns) size.columns = value;
    if (number(at, 2) == kRows) size.rows = value;
  }
  return size.columns > 0 && size.rows > 0 ? std::optional(size) : std::nullopt;
}

}  // namespace

std::optional<ImageSize> statedImageSize(Bytes bytes) {
  if (hasText(bytes, 0, "\x89PNG\r\n\x1a\n")) {
    if (bytes.size() < 24) return std::nullopt;
    return ImageSize{big(bytes, 16, 4), big(bytes, 20, 4)};
  }
  if (hasText(bytes, 0, "\xff\xd8")) return jpegSize(bytes);
  if (hasText(bytes, 0, "BM")) return bmpSize(bytes);
  if (hasText(bytes, 0, "RIFF") && hasText(bytes, 8, "WEBP")) return webpSize(bytes);
  if (hasText(bytes, 0, "II*") || hasText(bytes, 0, {"MM\0*", 4})) return tiffSize(bytes);
  return std::nullopt;
}

void requireWholeImage(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  const std::string_view text(reinterpret_cast<const char*>(mapped.bytes().data()),
                              mapped.bytes().size());
  // The end of the image follows its last scan. The data of a scan hold neither marker.
  const auto last = [&](std::string_view marker) { return text.rfind(marker) + 1; };
  if (text.starts_with("\xff\xd8") && last("\xff\xd9") <= last("\xff\xda")) {
    throw InputError(file.string(), "a JPEG that is cut off: its end is missing");
  }
  const auto size = statedImageSize(mapped.bytes());
  if (!size || size->columns == 0 || size->rows <= kMaxImagePixels / size->columns) return;
  throw InputError(file.string(), std::to_string(size->columns) + "x" + std::to_string(size->rows) +
                                      " px: expected at most " + std::to_string(kMaxImagePixels) +
                                      " px in all");
}

}  // namespace foci
