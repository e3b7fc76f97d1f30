#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace condyle {

/// Values as bytes, for files that this build of the program alone reads. A type names its members
/// once, for writing, reading and measuring:
///   template <class Archive> void fields(Archive& archive, T& value) { archive(value.a, value.b);
///   }
/// or as a member function fields(archive).

/// Types without padding and pointers, stored as their bytes: numbers, and what is declared so.
template <class T>
struct IsFlat : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
template <class T, std::size_t n>
struct IsFlat<std::array<T, n>> : IsFlat<T> {};
/// Matrices of fixed size.
template <class T>
requires(T::SizeAtCompileTime > 0) struct IsFlat<T>
    : std::bool_constant<sizeof(T) == sizeof(typename T::Scalar) *
                                          static_cast<std::size_t>(T::SizeAtCompileTime)> {
};

/// Descends to numbers, strings, lists and optional values by `Derived::bytes(data, size)`,
/// `Derived::size(list)` and `Derived::present(optional)`.
template <class Derived>
class ArchiveBase {
 public:
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

 private:
  Derived& self() { return static_cast<Derived&>(*this); }

  template <class T>
  void one(T& value) {
    if constexpr (IsFlat<T>::value)
      self().bytes(&value, sizeof value);
    else if constexpr (requires { value.fields(self()); })
      value.fields(self());
    else
      fields(self(), value);
  }
  template <class T>
  void one(std::vector<T>& list) {
    self().size(list);
    if constexpr (IsFlat<T>::value)
      self().bytes(list.data(), list.size() * sizeof(T));
    else
      for (T& value : list) one(value);
  }
  void one(std::string& text) {
    self().size(text);
    self().bytes(text.data(), text.size());
  }
  template <class T>
  void one(std::optional<T>& value) {
    self().present(value);
    if (value) one(*value);
  }
};

class ArchiveWriter : public ArchiveBase<ArchiveWriter> {
 public:
  static constexpr bool reading = false;
  void bytes(const void* data, std::size_t size) {
    result_.append(static_cast<const char*>(data), size);
  }
  template <class List>
  void size(const List& list) {
    const std::uint64_t count = list.size();
    bytes(&count, sizeof count);
  }
  template <class T>
  void present(const std::optional<T>& value) {
    const char is = value.has_value();
    bytes(&is, 1);
  }
  std::string take() { return std::move(result_); }

 private:
  std::string result_;
};

/// Reads what an ArchiveWriter wrote. Where the bytes do not suffice, numbers keep their values,
/// lists are empty and complete() is false.
class ArchiveReader : public ArchiveBase<ArchiveReader> {
 public:
  static constexpr bool reading = true;
  explicit ArchiveReader(std::string_view from) : left_(from) {}
  void bytes(void* data, std::size_t size) {
    if (size > left_.size()) {
      missing_ = true;
      left_ = {};
      return;
    }
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_.remove_prefix(size);
  }
  template <class List>
  void size(List& list) {
    std::uint64_t count = 0;
    bytes(&count, sizeof count);
    if (count > left_.size()) {  // each entry has a byte or more
      missing_ = true;
      left_ = {};
      count = 0;
    }
    list.resize(static_cast<std::size_t>(count));
  }
  template <class T>
  void present(std::optional<T>& value) {
    char is = 0;
    bytes(&is, 1);
    value = is ? std::optional<T>(T{}) : std::nullopt;
  }
  bool complete() const { return !missing_ && left_.empty(); }

 private:
  std::string_view left_;
  bool missing_ = false;
};

/// Measures the memory that lists hold, in bytes, those of strings included.
class ArchiveMeasure : public ArchiveBase<ArchiveMeasure> {
 public:
  static constexpr bool reading = false;
  void bytes(const void*, std::size_t) {}
  template <class List>
  void size(const List& list) {
    held_ += list.capacity() * sizeof(typename List::value_type);
  }
  template <class T>
  void present(const std::optional<T>&) {}
  std::size_t held() const { return held_; }

 private:
  std::size_t held_ = 0;
};

}  // namespace condyle
