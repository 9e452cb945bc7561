// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "kernel/hdf5/hdf5_library.hpp"

namespace suture::hdf5 {
namespace {

using Array = StateTree::Array;
using Scalar = Archive::Scalar;

constexpr std::size_t small = 1024;        // bytes; kept in the header of the dataset
constexpr std::size_t small_text = 60000;  // texts cannot be divided into chunks
constexpr std::size_t chunk = 1 << 20;     // bytes, about
constexpr std::size_t growth = 16u << 20;  // bytes; of the file in memory

bool is_attribute(const Array& array) {
  if (array.type == Scalar::text) return array.rows <= 256;
  return array.rows == 1 && array.columns <= 16;
}

// A value is a scalar, a row of several of them or a list a vector, a list of rows a matrix.
Id space_of(const Array& array, bool attribute) {
  const bool text = array.type == Scalar::text;
  const std::array<hsize_t, 2> sizes{array.rows, array.columns};
  hid_t space = -1;
  if (text && array.rows == 0)
    space = H5Screate(H5S_NULL);
  else if (text || (attribute && array.columns == 1))
    space = H5Screate(H5S_SCALAR);
  else if (attribute)
    space = H5Screate_simple(1, &sizes[1], nullptr);
  else
    space = H5Screate_simple(array.columns == 1 ? 1 : 2, sizes.data(), nullptr);
  return {space, H5Sclose, "describe an array"};
}

Id file_type_of(const Array& array) {
  if (array.type == Scalar::text) return text_type(array.rows);
  return {H5Tcopy(file_type(array.type)), H5Tclose, "describe an array"};
}

// Texts have one type in files and in memory.
hid_t memory_type_of(const Array& array, const Id& file) {
  return array.type == Scalar::text ? hid_t(file) : memory_type(array.type);
}

/// Property lists that all objects share.
struct Properties {
  Id links{H5Pcreate(H5P_LINK_CREATE), H5Pclose, "make properties"};
  Id groups{H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "make properties"};
  Id attributes{H5Pcreate(H5P_ATTRIBUTE_CREATE), H5Pclose, "make properties"};

  Properties() {
    good(H5Pset_char_encoding(links, H5T_CSET_UTF8), "set properties");
    good(H5Pset_char_encoding(attributes, H5T_CSET_UTF8), "set properties");
    good(H5Pset_obj_track_times(groups, false), "set properties");
    keep_together(groups);
  }
  // Beyond these numbers HDF5 makes an index, of kilobytes, for links and for attributes.
  static void keep_together(hid_t list) {
    good(H5Pset_link_phase_change(list, 64, 48), "set properties");
    good(H5Pset_attr_phase_change(list, 256, 192), "set properties");
  }
};

void write_attribute(hid_t group, const std::string& name, const Array& array,
                     const Properties& properties) {
  const std::string what = "write the attribute " + name;
  const Id space = space_of(array, true);
  const Id file = file_type_of(array);
  const Id attribute(
      H5Acreate2(group, name.c_str(), file, space, properties.attributes, H5P_DEFAULT), H5Aclose,
      what);
  if (array.rows == 0) return;
  good(H5Awrite(attribute, memory_type_of(array, file), array.bytes.get()), what);
}

void set_layout(hid_t list, const Array& array) {
  const bool text = array.type == Scalar::text;
  const std::size_t size = array.rows * array.columns * (text ? 1 : bytes_of(array.type));
  if (size <= (text ? small_text : small)) {
    good(H5Pset_layout(list, H5D_COMPACT), "set a layout");
    return;
  }
  if (!text) {
    const std::size_t chunks = (size + chunk - 1) / chunk;
    const std::array<hsize_t, 2> sizes{(array.rows + chunks - 1) / chunks, array.columns};
    good(H5Pset_chunk(list, array.columns == 1 ? 1 : 2, sizes.data()), "set a layout");
    good(H5Pset_fletcher32(list), "set a checksum");
  }
  good(H5Pset_fill_time(list, H5D_FILL_TIME_NEVER), "set a layout");
}

void write_dataset(hid_t group, const std::string& name, const Array& array,
                   const Properties& properties) {
  const std::string what = "write the dataset " + name;
  const Id space = space_of(array, false);
  const Id file = file_type_of(array);
  const Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, what);
  good(H5Pset_obj_track_times(list, false), what);
  set_layout(list, array);
  const Id dataset(
      H5Dcreate2(group, name.c_str(), file, space, properties.links, list, H5P_DEFAULT), H5Dclose,
      what);
  if (array.rows * array.columns == 0) return;
  good(H5Dwrite(dataset, memory_type_of(array, file), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                array.bytes.get()),
       what);
}

void write_group(hid_t group, StateTree& tree, const Properties& properties) {
  for (auto& [name, array] : tree.arrays) {
    const std::string link = to_link(name);
    if (is_attribute(array)) {
      write_attribute(group, link, array, properties);
    } else {
      if (tree.groups.contains(name))
        throw Failure{"a group and an array have the same name " + name};
      write_dataset(group, link, array, properties);
    }
    array.bytes.reset();
  }
  for (auto& [name, inner] : tree.groups) {
    const Id child(
        H5Gcreate2(group, to_link(name).c_str(), properties.links, properties.groups, H5P_DEFAULT),
        H5Gclose, "make the group " + name);
    write_group(child, inner, properties);
  }
}

// NOLINTBEGIN(cppcoreguidelines-no-malloc): HDF5 lets memory grow in place.
/// The memory of a file that HDF5 has closed: only then is the file marked as whole.
class Image {
 public:
  explicit Image(hid_t access) {
    H5FD_file_image_callbacks_t calls{allocate, assign, resize, release, copy, forget, this};
    good(H5Pset_file_image_callbacks(access, &calls), "make a file");
  }
  ~Image() { std::free(bytes_); }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  std::byte* bytes() const { return static_cast<std::byte*>(bytes_); }

 private:
  static void* allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
  static void* assign(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::memcpy(to, from, size);
  }
  static void* resize(void* bytes, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::realloc(bytes, size);
  }
  static herr_t release(void* bytes, H5FD_file_image_op_t when, void* image) {
    if (when == H5FD_FILE_IMAGE_OP_FILE_CLOSE) std::swap(bytes, static_cast<Image*>(image)->bytes_);
    std::free(bytes);
    return 0;
  }
  static void* copy(void* image) { return image; }
  static herr_t forget(void*) { return 0; }
  void* bytes_ = nullptr;
};
// NOLINTEND(cppcoreguidelines-no-malloc)

/// Fills a file in memory and returns its length.
std::size_t write_file(StateTree& tree, hid_t access) {
  const Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "make a file");
  good(H5Pset_obj_track_times(creation, false), "make a file");
  Properties::keep_together(creation);
  Id file(H5Fcreate("checkpoint in memory", H5F_ACC_TRUNC, creation, access), H5Fclose,
          "make a file");
  {
    const Properties properties;
    const Id root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "make a file");
    write_group(root, tree, properties);
  }
  good(H5Fflush(file, H5F_SCOPE_GLOBAL), "finish a file");
  // The length without what the memory has in reserve.
  const ssize_t size = good(H5Fget_file_image(file, nullptr, 0), "finish a file");
  good(H5Fclose(file.release()), "finish a file");
  return static_cast<std::size_t>(size);
}

}  // namespace

void write_tree(StateTree& tree, const std::function<void(std::span<const std::byte>)>& take) {
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a file");
  good(H5Pset_fapl_core(access, growth, false), "make a file");
  // Structures of older versions have no checksums.
  good(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110), "make a file");
  good(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "make a file");
  const Image image(access);
  const std::size_t size = write_file(tree, access);
  if (image.bytes() == nullptr) throw Failure{"HDF5 did not release the file image"};
  take({image.bytes(), size});
}

}  // namespace suture::hdf5
