// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "kernel/base/escape.hpp"
#include "kernel/mesh/vtk_order.hpp"
#include "kernel/mesh/writers.hpp"

namespace suture {
namespace {

using Sets = std::map<std::string, std::vector<Index>>;

// "ref 3" -> 3, 0 for another name: sets that came from Medit keep their number.
int medit_ref(const std::string& name) {
  int ref = 0;
  if (!name.starts_with("ref ")) return 0;
  const auto [stop, error] = std::from_chars(name.data() + 4, name.data() + name.size(), ref);
  return error == std::errc{} && stop == name.data() + name.size() ? ref : 0;
}

// One number per point or element. Sets that would need a second one are lost.
std::vector<int> refs_of(const Sets& sets, std::size_t count, const char* what, TextWriter& head,
                         Diagnostics& diagnostics) {
  std::vector<int> refs(count, 0);
  std::set<int> taken;
  for (const auto& [name, members] : sets) taken.insert(medit_ref(name));
  int next = 1;
  for (const auto& [name, members] : sets) {
    if (std::any_of(members.begin(), members.end(), [&](Index i) { return refs[i] != 0; })) {
      diagnostics.warn("the set " + quote(name) + " of " + what +
                       " overlaps another set and is lost: Medit stores only one reference per "
                       "point and element");
      continue;
    }
    int ref = medit_ref(name);
    if (ref == 0) {
      while (taken.count(next) > 0) ++next;
      ref = next++;
    }
    head << "# ref " << ref << " of " << what << ": " << name << '\n';
    for (const Index i : members) refs[i] = ref;
  }
  return refs;
}

// Names of arrays in legacy files end at white space.
std::string encoded(const std::string& name) {
  TextWriter text;
  for (const char c : name) {
    if (c > ' ' && c < 127 && c != '%' && c != '"') {
      text << c;
    } else {
      const char* digits = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(c);
      text << '%' << digits[byte >> 4] << digits[byte & 15];
    }
  }
  return text.take();
}

void legacy_array(TextWriter& out, const MeshArray& array) {
  out << encoded(array.name) << ' ' << array.components << ' '
      << array.values.size() / array.components << " double\n";
  for (const double x : array.values) out.big_endian(x);
  out << '\n';
}

void legacy_data(TextWriter& out, bool of_elements, const Mesh& mesh) {
  const Sets& sets = of_elements ? mesh.element_sets : mesh.point_sets;
  const auto& ids = of_elements ? mesh.element_ids : mesh.point_ids;
  const std::size_t count = of_elements ? mesh.hexahedra.size() : mesh.points.size();
  const auto written = [&](const MeshArray& a) {
    return a.of_elements == of_elements && !a.values.empty();
  };
  const auto arrays = std::count_if(mesh.arrays.begin(), mesh.arrays.end(), written);
  if (sets.empty() && ids.empty() && arrays == 0) return;
  out << (of_elements ? "CELL_DATA " : "POINT_DATA ") << count << '\n';
  if (!ids.empty()) {
    out << "GLOBAL_IDS " << (of_elements ? "element_ids" : "point_ids") << " vtktypeint64\n";
    for (const std::uint64_t id : ids) out.big_endian(id);
    out << '\n';
  }
  if (sets.empty() && arrays == 0) return;
  out << "FIELD FieldData " << sets.size() + static_cast<std::size_t>(arrays) << '\n';
  for (const auto& [name, members] : sets) {
    out << encoded(name) << " 1 " << count << " unsigned_char\n";
    std::string flags(count, '\0');
    for (const Index i : members) flags[i] = 1;
    out << flags << '\n';
  }
  for (const MeshArray& array : mesh.arrays)
    if (written(array)) legacy_array(out, array);
}

}  // namespace

std::string medit_text(const Mesh& mesh, Diagnostics& diagnostics) {
  TextWriter out;
  std::string arrays;
  for (const MeshArray& array : mesh.arrays)
    if (array.unreadable.empty()) arrays += (arrays.empty() ? "" : ", ") + quote(array.name);
  if (!arrays.empty())
    diagnostics.warn("arrays are lost: " + arrays +
                     "; Medit stores none, write .vtu, .vtk or .msh to keep them");
  out << "MeshVersionFormatted 2\n";
  const std::vector<int> point_refs =
      refs_of(mesh.point_sets, mesh.points.size(), "points", out, diagnostics);
  const std::vector<int> element_refs =
      refs_of(mesh.element_sets, mesh.hexahedra.size(), "hexahedra", out, diagnostics);
  out << "Dimension 3\nVertices " << mesh.points.size() << '\n';
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& x = mesh.points[i];
    out << x[0] << ' ' << x[1] << ' ' << x[2] << ' ' << point_refs[i] << '\n';
  }
  out << "Hexahedra " << mesh.hexahedra.size() << '\n';
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) {
    for (const Index node : swap_vtk_order(mesh.hexahedra[e])) out << node + 1 << ' ';
    out << element_refs[e] << '\n';
  }
  out << "End\n";
  return out.take();
}

// Version 4.2, which every reader knows; bytes, so that coordinates are exact.
std::string vtk_legacy_text(const Mesh& mesh) {
  TextWriter out;
  out.reserve(24 * mesh.points.size() + 40 * mesh.hexahedra.size() + 1024);
  out << "# vtk DataFile Version 4.2\nwritten by Suture\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
  out << "POINTS " << mesh.points.size() << " double\n";
  for (const Vec3& x : mesh.points) {
    for (const double c : x) out.big_endian(c);
  }
  out << "\nCELLS " << mesh.hexahedra.size() << ' ' << 9 * mesh.hexahedra.size() << '\n';
  for (const Hexahedron& nodes : mesh.hexahedra) {
    out.big_endian(std::int32_t{8});
    for (const Index node : swap_vtk_order(nodes)) out.big_endian(node);
  }
  out << "\nCELL_TYPES " << mesh.hexahedra.size() << '\n';
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) out.big_endian(std::int32_t{12});
  out << '\n';
  legacy_data(out, true, mesh);
  legacy_data(out, false, mesh);
  return out.take();
}

}  // namespace suture
