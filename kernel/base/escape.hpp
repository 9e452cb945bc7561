// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace suture {

// Names and texts from files, scenes and plugins may contain anything. Characters that a terminal
// would obey (control characters) or that change the order of the text (bidirectional controls),
// and bytes that are not UTF-8, become "\x1b", "\u202e", "\xff".

/// For a name within a message: line feeds and tabs become "\n" and "\t".
std::string escaped(std::string_view text);
/// For a whole message: line feeds and tabs stay.
std::string escaped_lines(std::string_view text);
/// An escaped name in single quotes.
std::string quote(std::string_view name);

}  // namespace suture
