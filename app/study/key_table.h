// A table of keys: how each is read from TOML (toml11), checked and written. toml11 is heavy to
// compile, so only study_keys.cpp includes this.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/study/toml_values.h"
#include "base/input_error.h"
#include "base/nearest.h"
#include "base/transformed.h"

namespace foci {

/// The known key that the user may have meant: near in spelling or in meaning, or nothing.
/// @param unknown  "section.key" or "key"
/// @param known    all keys
std::optional<std::string> suggestedKey(std::string_view unknown,
                                        const std::vector<std::string>& known);

/// The sections of the keys, in their order.
std::vector<std::string> sectionsOf(const std::vector<std::string>& known);

/// A key of T: of a study, or of an element of a list in it.
template <class T>
struct Key {
  std::string name;
  std::string_view meaning;
  Allowed allowed;
  void (*read)(const toml::value&, const Allowed&, T&);
  std::string (*write)(const T&);
  void (*reset)(T&);
  bool live = false;  ///< `changesLive`
};

/// The same key, which may change while a session runs.
template <class T>
Key<T> live(Key<T> key) {
  key.live = true;
  return key;
}

/// @param at  the member that the key sets
template <class T, auto at>
Key<T> key(std::string name, std::string_view meaning, Allowed allowed = {}) {
  return {std::move(name),
          meaning,
          std::move(allowed),
          [](const toml::value& from, const Allowed& a, T& to) { read(from, a, at(to)); },
          [](const T& from) { return write(at(from)); },
          [](T& to) {
            T fresh;
            at(to) = at(fresh);
          }};
}

/// The file of keys, for messages.
struct KeySource {
  std::string file;
  const TomlDocument* document = nullptr;  ///< null: lines are those that toml11 has parsed

  std::string place(const toml::value& value) const {
    const int line = lineIn(value.location());
    return file + ":" + std::to_string(document != nullptr ? document->lineOf(line) : line);
  }
};

inline InputError notAsExpected(const KeySource& source, const std::string& key,
                                const toml::value& value, const std::string& expected) {
  return {source.place(value), key + " = " + shownValue(value) + ": expected " + expected};
}

/// @param value  a table makes the name that of a section
inline InputError unknownKey(const std::string& where, const std::string& name,
                             const toml::value& value, const std::vector<std::string>& known) {
  const bool is_section = value.is_table() && name.find('.') == name.npos;
  auto near = is_section ? nearWord(name, sectionsOf(known)) : suggestedKey(name, known);
  if (!near && is_section && !value.as_table().empty()) {
    near = suggestedKey(name + "." + value.as_table().begin()->first, known);
  }
  return {where, (is_section ? "unknown section " : "unknown key ") + shownName(name) +
                     (near ? ": did you mean " + *near + "?" : "; foci keys lists the keys")};
}

template <class T>
std::vector<std::string> namesOf(const std::vector<Key<T>>& keys) {
  return transformed(keys, &Key<T>::name);
}

/// Applies a TOML table of keys with the given prefix to `to`.
/// @return the names of the keys set
template <class T>
KeyNames apply(const std::vector<Key<T>>& keys, const toml::table& table, const std::string& prefix,
               const KeySource& source, T& to) {
  KeyNames given;
  for (const auto& [name, value] : table) {
    const std::string full = prefix + name;
    const auto found = std::ranges::find(keys, full, &Key<T>::name);
    const bool is_section = std::ranges::any_of(
        keys, [&](const auto& key) { return key.name.starts_with(full + "."); });
    if (found != keys.end()) {
      try {
        found->read(value, found->allowed, to);
      } catch (const Expected& expected) {
        const std::string text =
            source.document != nullptr ? expected.text(*source.document) : expected.what;
        throw notAsExpected(source, full, value, text);
      }
      given.insert(full);
    } else if (is_section && value.is_table() && prefix.empty()) {
      given.merge(apply(keys, value.as_table(), full + ".", source, to));
    } else if (is_section) {
      throw notAsExpected(source, full, value, "a section of keys");
    } else {
      throw unknownKey(source.place(value), full, value, namesOf(keys));
    }
  }
  return given;
}

/// Reads a list of tables.
/// @param what    it is, for messages
/// @param each    one element is, for messages
/// @param needed  keys that no element may lack
template <class T>
void readList(const toml::value& from, const std::vector<Key<T>>& keys, const std::string& what,
              const std::string& each, std::initializer_list<const char*> needed,
              std::vector<T>& to) {
  if (!from.is_array() || from.as_array().empty() || from.as_array().size() > 10000) {
    throw Expected{what};
  }
  for (const toml::value& element : from.as_array()) {
    if (!element.is_table()) throw Expected{what};
    T value;
    // The caller, who knows the name of the file, puts it before the message.
    KeyNames given;
    try {
      given = apply(keys, element.as_table(), "", {}, value);
    } catch (const InputError& error) {
      const std::string text = error.what();  // ":LINE: ..."
      const std::size_t end = text.find(':', 1);
      throw Expected{"a list of " + each + "s", std::stoi(text.substr(1)), text.substr(end)};
    }
    for (const char* key : needed) {
      if (!given.contains(key)) throw Expected{std::string(key) + " in each " + each};
    }
    to.push_back(value);
  }
}

/// A list of tables as JSON.
template <class T>
std::string writeList(const std::vector<T>& values, const std::vector<Key<T>>& keys) {
  std::string text = "[";
  for (const T& value : values) {
    text += text.size() > 1 ? ", {" : "{";
    for (const auto& key : keys) {
      text +=
          (&key == keys.data() ? "\"" : ", \"") + std::string(key.name) + "\": " + key.write(value);
    }
    text += "}";
  }
  return text + "]";
}

}  // namespace foci
