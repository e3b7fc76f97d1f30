#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace condyle {

/// A value in a JSON file with its name there ("parts[2].role"). Access with the wrong type or
/// range throws an InputError with file, name and value.
class JsonItem {
 public:
  JsonItem(const std::filesystem::path& file, const nlohmann::json& value, std::string name)
      : file_(&file), value_(&value), name_(std::move(name)) {}

  const nlohmann::json& value() const { return *value_; }
  const std::string& name() const { return name_; }

  JsonItem at(const std::string& key) const;  // of an object; required
  std::optional<JsonItem> find(
      const std::string& key) const;     // of an object; absent if missing or null
  JsonItem at(std::size_t index) const;  // of a list
  std::size_t size() const;              // of a list
  std::string text() const;
  int integer(int low, int high) const;
  double number(double low, double high) const;
  /// throws: InputError if the object has other keys than these.
  void only_keys(std::initializer_list<std::string_view> known) const;

  [[noreturn]] void refuse(const std::string& problem) const;

 private:
  const std::filesystem::path* file_;
  const nlohmann::json* value_;
  std::string name_;
};

/// A parsed JSON text. throws: InputError naming the invalid line.
class JsonFile {
 public:
  JsonFile(const std::filesystem::path& file, std::string_view text);
  JsonItem root() const { return {file_, value_, ""}; }

 private:
  std::filesystem::path file_;
  nlohmann::json value_;
};

/// Path of the sidecar file FILE.json of a file ("chew.csv.json"); absent when there is none.
std::optional<std::filesystem::path> sidecar_of(const std::filesystem::path& file);

}  // namespace condyle
