// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace suture {

namespace archived {

template <class T>
inline constexpr bool is_vector = false;
template <class T, class A>
inline constexpr bool is_vector<std::vector<T, A>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

/// The number type of which (nested) arrays consist.
template <class T>
struct Element {
  using Number = T;
};
template <class T, std::size_t n>
struct Element<std::array<T, n>> : Element<T> {};
template <class T>
using Number = typename Element<T>::Number;

}  // namespace archived

/// An object writes its state to an archive, or reads it back. One function does both, so that the
/// two cannot differ:
///
///   void Guard::state(Archive& archive) {
///     archive("last", last_);
///     if (archive.has_cells()) archive("inverted", inverted_);
///   }
///
/// Values are numbers, enumerations, bools, strings, arrays, vectors and optionals of these, and
/// objects with a function `state`, which become groups.
class Archive {
 public:
  /// How much of the state is archived: what steps change, for a rollback within a run; or
  /// everything that differs from the scene as built, to continue in another process.
  enum class Extent { motion, everything };
  enum class Direction { save, load };

  virtual ~Archive() = default;
  bool loads() const { return direction_ == Direction::load; }
  /// True if the archive includes what operations change: cells, lists of cells and their columns.
  bool has_cells() const { return extent_ == Extent::everything; }

  template <class T>
  void operator()(const char* name, T& value) {
    if constexpr (requires { value.state(*this); }) {
      group(name, [&] { value.state(*this); });
    } else if constexpr (archived::is_vector<T>) {
      vector(name, value);
    } else if constexpr (archived::is_optional<T>) {
      optional(name, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      text(name, value);
    } else if constexpr (std::is_same_v<T, bool>) {
      auto byte = static_cast<std::uint8_t>(value);
      one(name, byte);
      value = byte != 0;
    } else if constexpr (std::is_enum_v<T>) {
      auto number = static_cast<std::int64_t>(value);
      one(name, number);
      value = static_cast<T>(number);
    } else {
      one(name, value);
    }
  }

  /// Calls body(), whose names then belong to the group `name`.
  template <class Body>
  void group(const char* name, Body body) {
    enter(name);
    body();
    leave();
  }

  /// A vector of structs that consist of `Number`s only, one row per struct.
  template <class Number, class Vector>
  void rows(const char* name, Vector& values) {
    using Row = typename Vector::value_type;
    static_assert(std::is_trivially_copyable_v<Row> && sizeof(Row) % sizeof(Number) == 0);
    numbers(name, scalar_of<Number>(), sizeof(Row) / sizeof(Number), sizeof(Row), values);
  }

  /// One member of a vector of structs, one row per struct. Loading all members in turn restores
  /// the vector; the first one restores its length.
  template <class Vector, class Object, class Member>
  void member(const char* name, Vector& objects, Member Object::*which) {
    std::vector<Member> values(objects.size());
    for (std::size_t i = 0; i < objects.size(); ++i) values[i] = objects[i].*which;
    (*this)(name, values);
    if (!loads()) return;
    objects.resize(values.size());
    for (std::size_t i = 0; i < objects.size(); ++i) objects[i].*which = values[i];
  }

  /// A vector of objects: calls item(archive, object) for each, in a group named after its index.
  template <class Vector, class Item>
  void each(const char* name, Vector& objects, Item item) {
    group(name, [&] {
      std::uint64_t count = objects.size();
      (*this)("count", count);
      if (loads()) keep_objects(objects, count);
      for (std::size_t i = 0; i < count; ++i) {
        group(std::to_string(i).c_str(), [&] {
          if (loads()) provide_object(objects, i);
          item(*this, objects[i]);
        });
      }
    });
  }
  template <class Vector>
  void each(const char* name, Vector& objects) {
    each(name, objects, [](Archive& archive, auto& object) { object.state(archive); });
  }

  /// Throws InputError that names the current group: the data read are not valid.
  [[noreturn]] virtual void refuse(const std::string& why) const = 0;
  /// refuse(why) unless `holds`.
  void require(bool holds, const char* why) const {
    if (!holds) refuse(why);
  }

  enum class Scalar : std::uint8_t { u8, i32, u32, i64, u64, f32, f64, text };

 protected:
  Archive(Extent extent, Direction direction) : extent_(extent), direction_(direction) {}

  /// `columns` numbers per row; a single value is one row.
  struct Shape {
    Scalar type;
    std::size_t columns, rows;
  };
  virtual void write(const char* name, const Shape& shape, const void* data) = 0;
  /// Returns the bytes passed to write() and sets `shape.rows`; type and columns are given and must
  /// match. Valid until the next call.
  virtual const void* read(const char* name, Shape& shape) = 0;
  virtual void enter(const char* name) = 0;
  virtual void leave() = 0;

 private:
  template <class T>
  static constexpr Scalar scalar_of() {
    if constexpr (std::is_enum_v<T>)
      return scalar_of<std::underlying_type_t<T>>();
    else if constexpr (std::is_same_v<T, float>)
      return Scalar::f32;
    else if constexpr (std::is_same_v<T, double>)
      return Scalar::f64;
    else if constexpr (sizeof(T) == 1)
      return Scalar::u8;
    else if constexpr (sizeof(T) == 4)
      return std::is_signed_v<T> ? Scalar::i32 : Scalar::u32;
    else {
      static_assert(sizeof(T) == 8 && std::is_integral_v<T>);
      return std::is_signed_v<T> ? Scalar::i64 : Scalar::u64;
    }
  }

  template <class T>
  void one(const char* name, T& value) {
    using Number = archived::Number<T>;
    Shape shape{scalar_of<Number>(), sizeof(T) / sizeof(Number), 1};
    if (!loads()) return write(name, shape, &value);
    const void* data = read(name, shape);
    require(shape.rows == 1, "expected one value, found several");
    std::memcpy(&value, data, sizeof(T));
  }

  template <class Vector>
  void numbers(const char* name, Scalar type, std::size_t columns, std::size_t row_bytes,
               Vector& values) {
    Shape shape{type, columns, values.size()};
    if (!loads()) return write(name, shape, values.data());
    const void* data = read(name, shape);
    values.resize(shape.rows);
    if (shape.rows != 0)
      std::memcpy(static_cast<void*>(values.data()), data, shape.rows * row_bytes);
  }

  template <class Vector>
  void vector(const char* name, Vector& values) {
    using T = typename Vector::value_type;
    if constexpr (std::is_same_v<T, bool>) {
      std::vector<std::uint8_t> bytes(values.begin(), values.end());
      numbers(name, Scalar::u8, 1, 1, bytes);
      if (loads()) values.assign(bytes.begin(), bytes.end());
    } else if constexpr (requires(T & item) { item.state(*this); }) {
      each(name, values);
    } else if constexpr (archived::is_vector<T>) {
      each(name, values, [](Archive& archive, T& inner) { archive("values", inner); });
    } else {
      using Number = archived::Number<T>;
      numbers(name, scalar_of<Number>(), sizeof(T) / sizeof(Number), sizeof(T), values);
    }
  }

  template <class T>
  void optional(const char* name, std::optional<T>& value) {
    group(name, [&] {
      bool has = value.has_value();
      (*this)("has", has);
      if (loads()) has ? void(value.emplace(T{})) : value.reset();
      if (has) (*this)("value", *value);
    });
  }

  void text(const char* name, std::string& value);

  /// At most `count` objects. More are provided one by one, each for a group that exists: memory
  /// for a damaged count might not.
  template <class Vector>
  void keep_objects(Vector& objects, std::uint64_t count) const {
    if constexpr (requires { objects.resize(count); }) {
      if (objects.size() > count) objects.resize(count);
    } else {
      require(objects.size() == count, "the number of items differs from this run");
    }
  }
  template <class Vector>
  static void provide_object(Vector& objects, std::size_t i) {
    if constexpr (requires { objects.resize(i); }) {
      if (objects.size() <= i) objects.resize(i + 1);
    }
  }

  Extent extent_;
  Direction direction_;
};

/// A state in memory: named arrays in named groups.
class StateTree {
 public:
  struct Array {
    Archive::Scalar type;
    std::size_t columns = 1, rows = 0;
    std::unique_ptr<std::byte[]> bytes;
    std::size_t capacity = 0;  ///< bytes, for save_state(); arrays made elsewhere have none
    std::size_t size() const;  ///< bytes
  };
  std::map<std::string, Array, std::less<>> arrays;
  std::map<std::string, StateTree, std::less<>> groups;

  std::size_t bytes() const;  ///< of all arrays
};

/// Saves the complete state of `holder`. `spare`: a state that is no longer needed, whose memory is
/// used again; 100 MB of fresh memory take longer than all that is copied there.
template <class Holder>
void save_state(StateTree& tree, Holder& holder, StateTree* spare = nullptr);
/// Restores it. Throws InputError with the path of an item that is missing or has a different type.
template <class Holder>
void load_state(const StateTree& tree, Holder& holder);

/// The archives that write and read a tree.
class TreeWriter : public Archive {
 public:
  explicit TreeWriter(StateTree& tree, StateTree* spare = nullptr);
  [[noreturn]] void refuse(const std::string& why) const override;

 private:
  void write(const char* name, const Shape& shape, const void* data) override;
  const void* read(const char* name, Shape& shape) override;
  void enter(const char* name) override;
  void leave() override;
  std::vector<StateTree*> path_, spares_;  ///< spares may be null
};

class TreeReader : public Archive {
 public:
  explicit TreeReader(const StateTree& tree);
  [[noreturn]] void refuse(const std::string& why) const override;

 private:
  void write(const char* name, const Shape& shape, const void* data) override;
  const void* read(const char* name, Shape& shape) override;
  void enter(const char* name) override;
  void leave() override;
  std::vector<const StateTree*> path_;
  std::vector<std::string> names_;
};

/// Drops everything: for a process that takes part in saving a complete state, which another one
/// writes.
class DroppingWriter : public Archive {
 public:
  DroppingWriter() : Archive(Extent::everything, Direction::save) {}
  [[noreturn]] void refuse(const std::string& why) const override;

 private:
  void write(const char*, const Shape&, const void*) override {}
  const void* read(const char* name, Shape& shape) override;
  void enter(const char*) override {}
  void leave() override {}
};

/// A state for a rollback within a run: what steps change, without names, in reused memory.
class StateBuffer {
 public:
  using Bytes = std::vector<std::uint8_t>;
  StateBuffer() = default;
  explicit StateBuffer(Bytes bytes) : bytes_(std::move(bytes)) {}
  template <class Holder>
  void save(Holder& holder) {
    bytes_.clear();
    if (bytes_.capacity() == 0) {  // growing would use half as much memory again
      Writer counter(nullptr);
      holder.state(counter);
      bytes_.reserve(counter.size());
    }
    Writer writer(&bytes_);
    holder.state(writer);
  }
  /// The holder must have the same cells as when it was saved.
  template <class Holder>
  void load(Holder& holder) const {
    Reader reader(bytes_);
    holder.state(reader);
  }
  const Bytes& bytes() const { return bytes_; }
  bool empty() const { return bytes_.empty(); }
  std::size_t size() const { return bytes_.size(); }  ///< B
  /// For buffers that are part of a saved state.
  void state(Archive& archive) { archive("bytes", bytes_); }

 private:
  class Writer : public Archive {
   public:
    /// Null: nothing is written, and size() returns the size that would be needed.
    explicit Writer(Bytes* bytes) : Archive(Extent::motion, Direction::save), bytes_(bytes) {}
    std::size_t size() const { return size_; }
    [[noreturn]] void refuse(const std::string& why) const override;

   private:
    void write(const char* name, const Shape& shape, const void* data) override;
    const void* read(const char* name, Shape& shape) override;
    void enter(const char*) override {}
    void leave() override {}
    Bytes* bytes_;
    std::size_t size_ = 0;
  };
  class Reader : public Archive {
   public:
    explicit Reader(const Bytes& bytes) : Archive(Extent::motion, Direction::load), bytes_(bytes) {}
    [[noreturn]] void refuse(const std::string& why) const override;

   private:
    void write(const char* name, const Shape& shape, const void* data) override;
    const void* read(const char* name, Shape& shape) override;
    void enter(const char*) override {}
    void leave() override {}
    const Bytes& bytes_;
    std::size_t at_ = 0;
  };
  Bytes bytes_;
};

template <class Holder>
void save_state(StateTree& tree, Holder& holder, StateTree* spare) {
  TreeWriter writer(tree, spare);
  holder.state(writer);
}

template <class Holder>
void load_state(const StateTree& tree, Holder& holder) {
  TreeReader reader(tree);
  holder.state(reader);
}

}  // namespace suture
