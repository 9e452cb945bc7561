// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module itself: the factory, HDF5's errors, its types and names.
#include "kernel/hdf5/hdf5_library.hpp"

#include <mutex>

#include "kernel/hdf5/hdf5_module.hpp"

namespace suture::hdf5 {
namespace {

// The first error is the innermost one: where it happened.
herr_t keep_first(unsigned, const H5E_error2_t* error, void* data) noexcept {
  auto& text = *static_cast<const char**>(data);
  if (text == nullptr && error->desc != nullptr) text = error->desc;
  return 0;
}

/// body() with HDF5 silent, one thread at a time; the text of what it failed with.
template <class Body>
std::string guarded(Body body) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  try {
    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    // HDF5 ends the program if they differ.
    if (major != H5_VERS_MAJOR || minor != H5_VERS_MINOR || release != H5_VERS_RELEASE)
      throw Failure{"libhdf5 is " + std::to_string(major) + '.' + std::to_string(minor) + '.' +
                    std::to_string(release) +
                    ", but Suture was built with " H5_VERS_INFO "; rebuild Suture"};
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5Eclear2(H5E_DEFAULT);
    body();
    return {};
  } catch (const Failure& failure) {
    return failure.text;
  }
}

class Library final : public Hdf5Module {
 public:
  std::string write(StateTree&& tree,
                    const std::function<void(std::span<const std::byte>)>& take) const override {
    return guarded([&] { write_tree(tree, take); });
  }
  std::string read(const std::string& path, StateTree& tree) const override {
    return guarded([&] { read_tree(path, tree); });
  }
};

}  // namespace

void fail(const std::string& what) {
  const char* reason = nullptr;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  throw Failure{"HDF5 cannot " + what + (reason == nullptr ? "" : std::string(": ") + reason)};
}

hid_t file_type(Archive::Scalar type) {
  switch (type) {
    case Archive::Scalar::i32:
      return H5T_STD_I32LE;
    case Archive::Scalar::u32:
      return H5T_STD_U32LE;
    case Archive::Scalar::i64:
      return H5T_STD_I64LE;
    case Archive::Scalar::u64:
      return H5T_STD_U64LE;
    case Archive::Scalar::f32:
      return H5T_IEEE_F32LE;
    case Archive::Scalar::f64:
      return H5T_IEEE_F64LE;
    case Archive::Scalar::u8:
    case Archive::Scalar::text:
      break;
  }
  return H5T_STD_U8LE;
}

hid_t memory_type(Archive::Scalar type) {
  switch (type) {
    case Archive::Scalar::i32:
      return H5T_NATIVE_INT32;
    case Archive::Scalar::u32:
      return H5T_NATIVE_UINT32;
    case Archive::Scalar::i64:
      return H5T_NATIVE_INT64;
    case Archive::Scalar::u64:
      return H5T_NATIVE_UINT64;
    case Archive::Scalar::f32:
      return H5T_NATIVE_FLOAT;
    case Archive::Scalar::f64:
      return H5T_NATIVE_DOUBLE;
    case Archive::Scalar::u8:
    case Archive::Scalar::text:
      break;
  }
  return H5T_NATIVE_UINT8;
}

Id text_type(std::size_t size) {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose, "make a type of text");
  good(H5Tset_size(type, size == 0 ? 1 : size), "make a type of text");
  good(H5Tset_strpad(type, H5T_STR_NULLPAD), "make a type of text");
  good(H5Tset_cset(type, H5T_CSET_UTF8), "make a type of text");
  return type;
}

std::size_t bytes_of(Archive::Scalar type) { return H5Tget_size(file_type(type)); }

std::string to_link(std::string_view name) {
  if (name.empty()) return "%00";
  if (name == ".") return "%2E";
  std::string link;
  for (const char c : name) {
    if (c == '/')
      link += "%2F";
    else if (c == '%')
      link += "%25";
    else
      link += c;
  }
  return link;
}

std::string from_link(std::string_view link) {
  std::string name;
  while (!link.empty()) {
    const std::string_view code = link.substr(0, 3);
    const bool escaped = code == "%2F" || code == "%2E" || code == "%25" || code == "%00";
    if (!escaped)
      name += link[0];
    else if (code != "%00")
      name += code == "%2F" ? '/' : code == "%2E" ? '.' : '%';
    link.remove_prefix(escaped ? 3 : 1);
  }
  return name;
}

}  // namespace suture::hdf5

extern "C" __attribute__((visibility("default"))) const suture::Hdf5Module* suture_hdf5_module_1() {
  static const suture::hdf5::Library library;
  return &library;
}
