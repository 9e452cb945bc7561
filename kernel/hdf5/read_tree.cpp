// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <limits>
#include <new>
#include <optional>
#include <vector>

#include "kernel/hdf5/hdf5_library.hpp"

namespace suture::hdf5 {
namespace {

using Array = StateTree::Array;
using Scalar = Archive::Scalar;

// Deeper ones are rings.
constexpr int deepest = 100;

std::optional<Scalar> scalar_of(hid_t type) {
  for (const Scalar scalar :
       {Scalar::u8, Scalar::i32, Scalar::u32, Scalar::i64, Scalar::u64, Scalar::f32, Scalar::f64}) {
    if (good(H5Tequal(type, file_type(scalar)), "read a type") > 0) return scalar;
  }
  return std::nullopt;
}

/// An array of this type and space, without its values. Of an attribute one dimension is the
/// columns of one row.
Array described(const Id& type, const Id& space, bool attribute, const std::string& name) {
  std::array<hsize_t, 2> sizes{1, 1};
  const int rank = good(H5Sget_simple_extent_ndims(space), "read the size of " + name);
  if (rank > 2) throw Failure{name + " has more than two dimensions"};
  const bool null = H5Sget_simple_extent_type(space) == H5S_NULL;
  if (H5Tget_class(type) == H5T_STRING) {
    if (rank != 0 || H5Tis_variable_str(type) != 0) throw Failure{name + " is not a single text"};
    return {Scalar::text, 1, null ? 0 : H5Tget_size(type), nullptr};
  }
  const std::optional<Scalar> scalar = scalar_of(type);
  if (!scalar || null) throw Failure{name + " has numbers of an unknown type"};
  if (rank > 0)
    good(H5Sget_simple_extent_dims(space, sizes.data(), nullptr), "read the size of " + name);
  if (attribute && rank == 1) std::swap(sizes[0], sizes[1]);
  if (sizes[1] != 0 &&
      sizes[0] > std::numeric_limits<std::size_t>::max() / sizes[1] / bytes_of(*scalar))
    throw Failure{name + " exceeds the address space"};
  return {*scalar, sizes[1], sizes[0], nullptr};
}

/// The array with its values, read by read(memory type, to).
template <class Read>
Array filled(Array array, const Id& type, const std::string& name, Read read) {
  const bool text = array.type == Scalar::text;
  const std::size_t size = array.rows * array.columns * (text ? 1 : bytes_of(array.type));
  try {
    array.bytes = std::make_unique_for_overwrite<std::byte[]>(size);
  } catch (const std::bad_alloc&) {
    throw Failure{"not enough memory for " + name + ", " + std::to_string(size) + " bytes"};
  }
  if (size != 0)
    good(read(text ? hid_t(type) : memory_type(array.type), array.bytes.get()), "read " + name);
  return array;
}

Array read_attribute(hid_t group, const std::string& name) {
  const Id attribute(H5Aopen(group, name.c_str(), H5P_DEFAULT), H5Aclose, "open " + name);
  const Id type(H5Aget_type(attribute), H5Tclose, "read the type of " + name);
  const Id space(H5Aget_space(attribute), H5Sclose, "read the size of " + name);
  return filled(described(type, space, true, name), type, name,
                [&](hid_t memory, void* to) { return H5Aread(attribute, memory, to); });
}

Array read_dataset(hid_t dataset, const std::string& name) {
  const Id type(H5Dget_type(dataset), H5Tclose, "read the type of " + name);
  const Id space(H5Dget_space(dataset), H5Sclose, "read the size of " + name);
  return filled(described(type, space, false, name), type, name, [&](hid_t memory, void* to) {
    return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
  });
}

// No exception may pass through HDF5.
herr_t append(const char* name, void* data) noexcept {
  try {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  } catch (const std::bad_alloc&) {
    return -1;
  }
}
herr_t append_link(hid_t, const char* name, const H5L_info_t*, void* data) noexcept {
  return append(name, data);
}
herr_t append_attribute(hid_t, const char* name, const H5A_info_t*, void* data) noexcept {
  return append(name, data);
}

void read_group(hid_t group, StateTree& tree, int depth) {
  if (depth > deepest) throw Failure{"its groups are nested too deeply"};
  std::vector<std::string> names;
  good(H5Aiterate2(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_attribute, &names),
       "list attributes");
  for (const std::string& name : names)
    tree.arrays.insert_or_assign(from_link(name), read_attribute(group, name));
  names.clear();
  good(H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_link, &names),
       "list a group");
  for (const std::string& name : names) {
    const Id object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open " + name);
    const H5I_type_t kind = H5Iget_type(object);
    if (kind == H5I_GROUP)
      read_group(object, tree.groups[from_link(name)], depth + 1);
    else if (kind == H5I_DATASET)
      tree.arrays.insert_or_assign(from_link(name), read_dataset(object, name));
    else
      throw Failure{name + " is neither a group nor a dataset"};
  }
}

}  // namespace

void read_tree(const std::string& path, StateTree& tree) {
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "open the file");
  // Some file systems of clusters know no locks.
  good(H5Pset_file_locking(access, false, true), "open the file");
  good(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "open the file");
  const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "open the file");
  const Id root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "open the file");
  read_group(root, tree, 0);
}

}  // namespace suture::hdf5
