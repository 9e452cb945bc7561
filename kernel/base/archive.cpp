// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/archive.hpp"

#include <stdexcept>
#include <utility>

#include "kernel/base/bulk.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::size_t bytes_of(Archive::Scalar type) {
  switch (type) {
    case Archive::Scalar::i32:
    case Archive::Scalar::u32:
    case Archive::Scalar::f32:
      return 4;
    case Archive::Scalar::i64:
    case Archive::Scalar::u64:
    case Archive::Scalar::f64:
      return 8;
    case Archive::Scalar::u8:
    case Archive::Scalar::text:
      break;
  }
  return 1;
}

const char* name_of(Archive::Scalar type) {
  constexpr const char* names[] = {
      "8-bit integers",           "32-bit integers", "unsigned integers", "64-bit integers",
      "64-bit unsigned integers", "floats",          "doubles",           "text"};
  return names[static_cast<std::size_t>(type)];
}

[[noreturn]] void wrong_way() {
  throw std::logic_error("an archive was used in the wrong direction");
}

}  // namespace

void Archive::text(const char* name, std::string& value) {
  Shape shape{Scalar::text, 1, value.size()};
  if (!loads()) return write(name, shape, value.data());
  const void* data = read(name, shape);
  value.assign(static_cast<const char*>(data), shape.rows);
}

// -------------------------------------------------------------------- trees --

std::size_t StateTree::Array::size() const { return rows * columns * bytes_of(type); }

std::size_t StateTree::bytes() const {
  std::size_t sum = 0;
  for (const auto& [name, array] : arrays) sum += array.size();
  for (const auto& [name, group] : groups) sum += group.bytes();
  return sum;
}

namespace {

/// Memory for an array, with some more for the cells that operations add.
void provide(StateTree::Array& array, const char* name, StateTree* spare) {
  if (spare)
    if (const auto found = spare->arrays.find(name);
        found != spare->arrays.end() && found->second.capacity >= array.size()) {
      array.bytes = std::move(found->second.bytes);
      array.capacity = std::exchange(found->second.capacity, 0);
      return;
    }
  array.capacity = array.size() + array.size() / 16;
  array.bytes = std::make_unique_for_overwrite<std::byte[]>(array.capacity);
  prefer_large_pages(array.bytes.get(), array.capacity);
}

}  // namespace

TreeWriter::TreeWriter(StateTree& tree, StateTree* spare)
    : Archive(Extent::everything, Direction::save), path_{&tree}, spares_{spare} {}

void TreeWriter::refuse(const std::string& why) const { throw std::logic_error(why); }

void TreeWriter::write(const char* name, const Shape& shape, const void* data) {
  StateTree::Array array{shape.type, shape.columns, shape.rows, nullptr};
  provide(array, name, spares_.back());
  if (array.size() != 0) std::memcpy(array.bytes.get(), data, array.size());
  if (!path_.back()->arrays.emplace(name, std::move(array)).second)
    throw std::logic_error(std::string("two states have the same name ") + name);
}

const void* TreeWriter::read(const char*, Shape&) { wrong_way(); }
void TreeWriter::enter(const char* name) {
  path_.push_back(&path_.back()->groups[name]);
  StateTree* spare = spares_.back();
  if (spare) {
    const auto found = spare->groups.find(name);
    spare = found == spare->groups.end() ? nullptr : &found->second;
  }
  spares_.push_back(spare);
}
void TreeWriter::leave() {
  path_.pop_back();
  spares_.pop_back();
}

TreeReader::TreeReader(const StateTree& tree)
    : Archive(Extent::everything, Direction::load), path_{&tree} {}

void TreeReader::refuse(const std::string& why) const {
  std::string where;
  for (const std::string& name : names_) where += '/' + name;
  throw InputError((where.empty() ? "/" : where) + ": " + why);
}

void TreeReader::write(const char*, const Shape&, const void*) { wrong_way(); }

const void* TreeReader::read(const char* name, Shape& shape) {
  const auto found = path_.back()->arrays.find(name);
  if (found == path_.back()->arrays.end()) refuse(std::string("missing entry ") + name);
  const StateTree::Array& array = found->second;
  if (array.type != shape.type || array.columns != shape.columns)
    refuse(std::string(name) + " has " + std::to_string(array.columns) + ' ' + name_of(array.type) +
           " per row, expected " + std::to_string(shape.columns) + ' ' + name_of(shape.type));
  shape.rows = array.rows;
  return array.bytes.get();
}

void TreeReader::enter(const char* name) {
  const auto found = path_.back()->groups.find(name);
  if (found == path_.back()->groups.end()) refuse(std::string("missing entry ") + name);
  path_.push_back(&found->second);
  names_.emplace_back(name);
}

void TreeReader::leave() {
  path_.pop_back();
  names_.pop_back();
}

void DroppingWriter::refuse(const std::string& why) const { throw std::logic_error(why); }
const void* DroppingWriter::read(const char*, Shape&) { wrong_way(); }

// ------------------------------------------------------------------ buffers --

void StateBuffer::Writer::refuse(const std::string& why) const { throw std::logic_error(why); }
void StateBuffer::Reader::refuse(const std::string& why) const { throw std::logic_error(why); }
const void* StateBuffer::Writer::read(const char*, Shape&) { wrong_way(); }
void StateBuffer::Reader::write(const char*, const Shape&, const void*) { wrong_way(); }

void StateBuffer::Writer::write(const char*, const Shape& shape, const void* data) {
  const std::uint64_t rows = shape.rows;
  const std::size_t bytes = shape.rows * shape.columns * bytes_of(shape.type);
  size_ += sizeof rows + bytes;
  if (bytes_ == nullptr) return;
  if (bytes_->capacity() < size_) bytes_->reserve(size_ + size_ / 8);
  const auto append = [&](const void* from, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    if (size != 0) bytes_->insert(bytes_->end(), first, first + size);
  };
  append(&rows, sizeof rows);
  append(data, bytes);
}

const void* StateBuffer::Reader::read(const char*, Shape& shape) {
  std::uint64_t rows = 0;
  std::memcpy(&rows, bytes_.data() + at_, sizeof rows);
  shape.rows = rows;
  const std::uint8_t* data = bytes_.data() + at_ + sizeof rows;
  at_ += sizeof rows + rows * shape.columns * bytes_of(shape.type);
  return data;
}

}  // namespace suture
