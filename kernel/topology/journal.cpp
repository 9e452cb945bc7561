// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/journal.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "kernel/base/file.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

constexpr std::array<const char*, 5> kinds = {"cut", "tear", "pierce", "sew", "clone"};

/// Numbers that follow the count of an operation, for each counted thing.
std::size_t width(Operation::Kind kind) { return kind == Operation::Kind::sew ? 2 : 1; }

class Reader {
 public:
  explicit Reader(const FileText& file) : in_(file, TextCursor::Comments::hash) {}

  Journal read() {
    in_.expect("suture-journal");
    if (const int version = in_.integer<int>("version"); version != 1)
      in_.fail("version " + std::to_string(version) +
               " of the journal is not supported; expected 1");
    in_.expect("points");
    journal_.mesh.points.resize(count(3, "points"));
    for (Vec3& point : journal_.mesh.points)
      for (double& x : point) x = in_.real("coordinate");
    in_.expect("hexahedra");
    journal_.mesh.hexahedra.resize(count(8, "hexahedra"));
    for (Hexahedron& h : journal_.mesh.hexahedra)
      for (Index& v : h) v = number("point", journal_.mesh.points.size());
    in_.expect("operations");
    journal_.operations.resize(count(2, "operations"));
    elements_ = journal_.mesh.hexahedra.size();
    for (Operation& operation : journal_.operations) read(operation);
    if (in_.skip_space()) in_.fail("more data than declared: " + in_quotes(in_.peek_word()));
    return std::move(journal_);
  }

 private:
  std::size_t count(std::uint64_t words, const char* what) {
    const auto n = in_.integer<std::uint64_t>("a count");
    in_.require_room(n, words, what);
    return n;
  }

  Index number(const char* what, std::size_t end) {
    const auto n = in_.integer<Index>(what);
    if (n >= end)
      in_.fail(std::string(what) + " " + std::to_string(n) + "; there are " + std::to_string(end));
    return n;
  }

  void read(Operation& operation) {
    const std::string kind(in_.word("an operation"));
    const auto found = std::ranges::find(kinds, kind);
    if (found == kinds.end())
      in_.fail("operation " + in_quotes(kind) +
               did_you_mean(kind, std::vector<std::string>(kinds.begin(), kinds.end())) +
               "; expected cut, tear, pierce, sew or clone");
    operation.kind = static_cast<Operation::Kind>(found - kinds.begin());
    const std::size_t darts = elements_ * hexahedron::darts;
    switch (operation.kind) {
      case Operation::Kind::clone:
        return read_clone(operation);
      case Operation::Kind::pierce:
        return read_list(operation.numbers, 1, "element", elements_);
      default:
        return read_list(operation.numbers, width(operation.kind), "dart", darts);
    }
  }

  void read_clone(Operation& operation) {
    read_list(operation.numbers, 1, "element", elements_);
    elements_ += operation.numbers.size();
    in_.expect("sew");
    read_list(operation.seams, 2, "dart", elements_ * hexahedron::darts);
    in_.expect("cut");
    read_list(operation.cut, 1, "dart", elements_ * hexahedron::darts);
    in_.expect("absorb");
    read_list(operation.absorbed, 2, "element", elements_);
  }

  void read_list(std::vector<Index>& list, std::size_t width, const char* what, std::size_t end) {
    list.resize(count(width, "items") * width);
    for (Index& n : list) n = number(what, end);
  }

  TextCursor in_;
  Journal journal_;
  std::size_t elements_ = 0;  ///< with the copies that the lines before have made
};

std::string text_of(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

template <class Values, class Text>
void append_line(std::string& out, const Values& values, const Text& text) {
  for (const auto& value : values) out += (&value == &*values.begin() ? "" : " ") + text(value);
  out += '\n';
}

std::string text_of(const Journal& journal) {
  std::string out = "suture-journal 1\n";
  if (!journal.remark.empty()) out += "# " + journal.remark + "\n";
  out += "points " + std::to_string(journal.mesh.points.size()) + "\n";
  for (const Vec3& point : journal.mesh.points)
    append_line(out, point, [](double x) { return text_of(x); });
  const auto integer = [](Index i) { return std::to_string(i); };
  out += "hexahedra " + std::to_string(journal.mesh.hexahedra.size()) + "\n";
  for (const Hexahedron& h : journal.mesh.hexahedra) append_line(out, h, integer);
  out += "operations " + std::to_string(journal.operations.size()) + "\n";
  const auto list = [&](const char* name, const std::vector<Index>& numbers, std::size_t width) {
    out += std::string(name) + " " + std::to_string(numbers.size() / width) + "  ";
    append_line(out, numbers, integer);
  };
  for (const Operation& operation : journal.operations) {
    list(name_of(operation.kind), operation.numbers, width(operation.kind));
    if (operation.kind != Operation::Kind::clone) continue;
    list("  sew", operation.seams, 2);
    list("  cut", operation.cut, 1);
    list("  absorb", operation.absorbed, 2);
  }
  return out;
}

/// One dart for each face, the smaller side's first one, ascending.
void unique_faces(const CellComplex& complex, std::vector<Dart>& faces) {
  for (Dart& d : faces) d = std::min(d & ~3u, complex.beta3(d) & ~3u);
  sort_unique(faces);
}

void request_cut(const CellComplex& complex, const Operation& operation, Request& result) {
  for (const Dart d : operation.numbers)
    if (complex.can_cut(d))
      result.faces.push_back(d);
    else
      ++result.left_out;
  unique_faces(complex, result.faces);
}

/// The three faces at the corner of each element around the vertex.
void request_tear(const CellComplex& complex, const Operation& operation, Request& result) {
  std::vector<Dart> star;
  for (const Dart d : operation.numbers) {
    const Index element = d / hexahedron::darts;
    if (element >= complex.element_count() || !complex.exists(3, element)) {
      ++result.left_out;
      continue;
    }
    complex.star(0, complex.origin(d), star);
    for (const Dart corner : star)
      for (const auto exit : incidence::exits<0>[incidence::local_cell_of<0>(corner) & 15]) {
        const Dart face = corner - corner % hexahedron::darts + 4 * exit.face;
        if (complex.can_cut(face)) result.faces.push_back(face);
      }
  }
  unique_faces(complex, result.faces);
}

void request_pierce(const CellComplex& complex, const Operation& operation, Request& result) {
  result.elements = operation.numbers;
  sort_unique(result.elements);
  const auto gone = std::erase_if(result.elements, [&](Index e) { return !complex.can_pierce(e); });
  result.left_out += static_cast<Index>(gone);
  if (!result.elements.empty() && result.elements.size() == complex.existing(3)) {
    result.elements.erase(result.elements.begin());
    ++result.left_out;
  }
}

void request_sew(const CellComplex& complex, const Operation& operation, Request& result) {
  std::vector<Dart> taken;
  const auto is_free = [&](Dart d) { return std::ranges::find(taken, d & ~3u) == taken.end(); };
  for (std::size_t i = 0; i + 1 < operation.numbers.size(); i += 2) {
    const Seam seam{operation.numbers[i], operation.numbers[i + 1]};
    if (!is_free(seam.one) || !is_free(seam.other) || !complex.can_sew(seam.one, seam.other)) {
      ++result.left_out;
      continue;
    }
    taken.insert(taken.end(), {seam.one & ~3u, seam.other & ~3u});
    result.seams.push_back(seam);
  }
}

void request_clone(const Operation& operation, Request& result) {
  Cloning& cloning = result.cloning;
  cloning = {operation.numbers, {}, operation.cut};
  for (std::size_t i = 0; i + 1 < operation.seams.size(); i += 2)
    cloning.seams.push_back({operation.seams[i], operation.seams[i + 1]});
  for (std::size_t i = 0; i + 1 < operation.absorbed.size(); i += 2)
    cloning.absorbed.push_back({operation.absorbed[i], operation.absorbed[i + 1]});
}

}  // namespace

const char* name_of(Operation::Kind kind) { return kinds[static_cast<std::size_t>(kind)]; }

Operation operation_of(const Cloning& cloning) {
  Operation operation{Operation::Kind::clone, cloning.origins, {}, cloning.cut};
  for (const auto& [one, other] : cloning.seams)
    operation.seams.insert(operation.seams.end(), {one, other});
  for (const auto& [element, copy] : cloning.absorbed)
    operation.absorbed.insert(operation.absorbed.end(), {element, copy});
  return operation;
}

Journal read_journal(const std::filesystem::path& path) {
  const FileText file(path);
  Journal journal = Reader(file).read();
  journal.mesh.source = file.name();
  return journal;
}

void write_journal(const std::filesystem::path& path, const Journal& journal) {
  write_file(path, text_of(journal));
}

Request request(const CellComplex& complex, const Operation& operation) {
  Request result{operation.kind, {}, {}, {}};
  switch (operation.kind) {
    case Operation::Kind::cut:
      request_cut(complex, operation, result);
      break;
    case Operation::Kind::tear:
      request_tear(complex, operation, result);
      break;
    case Operation::Kind::pierce:
      request_pierce(complex, operation, result);
      break;
    case Operation::Kind::sew:
      request_sew(complex, operation, result);
      break;
    case Operation::Kind::clone:
      request_clone(operation, result);
      break;
  }
  return result;
}

TopologyChange apply(CellComplex& complex, const Request& request) {
  switch (request.kind) {
    case Operation::Kind::pierce:
      return complex.pierce(request.elements);
    case Operation::Kind::sew:
      return complex.sew(request.seams);
    case Operation::Kind::clone:
      return complex.clone_volume(request.cloning);
    default:
      return complex.cut(request.faces);
  }
}

}  // namespace suture
