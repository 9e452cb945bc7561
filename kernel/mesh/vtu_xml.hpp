// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "kernel/mesh/readers.hpp"

// The XML of .vtu files: tags and attributes, to the extent used by VTK's writers.

namespace suture {

/// <name key="value" ...>, </name> or <name ... />; views into the file.
struct XmlTag {
  std::string_view name;
  std::string_view attributes;
  bool closes = false;         ///< </name>
  bool closes_itself = false;  ///< <name ... />
  const char* at = nullptr;    ///< its '<'
  const char* end = nullptr;   ///< after its '>'

  /// The value as written in the file; empty if there is none.
  std::string_view operator[](std::string_view key) const;
};

/// The text of an attribute, with &quot; &amp; &lt; &gt; &apos; replaced.
std::string unescaped(std::string_view value);

/// Moves from tag to tag; comments and declarations are skipped.
class XmlCursor {
 public:
  explicit XmlCursor(const FileText& file) : file_(file), p_(file.begin()) {}
  /// The next tag; none at the end of the file. Fails for a tag without end, with malformed
  /// attributes or that closes another element than the last one opened, and at the end of a
  /// file that leaves an element open.
  std::optional<XmlTag> next();
  /// The element around the last tag; an empty one around the root.
  const XmlTag& enclosing() const { return enclosing_; }
  /// Where the next tag begins: the end of the text from here on.
  const char* end_of_text() const;
  void seek(const char* p) { p_ = p; }

 private:
  XmlTag tag_at(const char* at, std::string_view inside) const;
  void nest(const XmlTag& tag);
  [[noreturn]] void fail_open() const;

  const FileText& file_;
  const char* p_;
  std::vector<XmlTag> open_;
  XmlTag enclosing_;
};

}  // namespace suture
