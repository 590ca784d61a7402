// What the program's pages share: one style, and text quoted for HTML.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace foci {

/// The pages' style sheet, light or dark as the reader's system is.
extern const char* const kPageStyle;

/// A page up to and including <main>; `kPageEnd` closes it.
/// @param title  plain text
/// @param style  CSS besides `kPageStyle`
/// @param head   more of <head>, as HTML
std::string pageStart(const std::string& title, const std::string& style,
                      const std::string& head = "");
extern const char* const kPageEnd;

/// Plain text as the text or an attribute of an element of HTML or SVG, with control characters as
/// escapes.
std::string escaped(const std::string& text);

/// A relative path as a link (RFC 3986): the value of an attribute, without quotes.
std::string hrefOf(const std::string& file);

/// The bytes of an image file as its address (RFC 2397): the value of an attribute.
/// @param type  "jpeg" or "png"
std::string imageUri(const std::string& bytes, const std::string& type = "jpeg");

/// Texts that the reader should know first, each in a paragraph that stands out. Plain text.
std::string noticesOf(const std::vector<std::string>& texts);

/// A cell of a table.
/// @param text  HTML
/// @param kind  CSS class
std::string cell(const std::string& text, const char* kind = "");

/// A number and its name, as a cell of a `numbers` block. Both are HTML.
std::string numberCell(const std::string& value, const std::string& what);
/// The same of a count: "1" of "run", or "2" of "runs".
std::string numberCell(std::size_t count, const std::string& one);

}  // namespace foci
