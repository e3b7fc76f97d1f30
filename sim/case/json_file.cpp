#include "sim/case/json_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/mesh_io/json_depth.h"

namespace condyle {
namespace {

/// The value, shortened for a message.
std::string shown(const nlohmann::json& value) {
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 60) + "..." : text;
}

/// The message of nlohmann::json without its prefix and position.
std::string reason_of(const nlohmann::json::exception& error) {
  const std::string what = error.what();
  const std::size_t end = what.find("; last read");
  const std::size_t start = what.find("] ") + 2;
  const std::size_t colon = what.find(": ", start);
  if (colon == std::string::npos) return what.substr(start);
  return what.substr(colon + 2, end == std::string::npos ? end : end - colon - 2);
}

}  // namespace

void JsonItem::refuse(const std::string& problem) const {
  throw InputError(*file_, name_.empty() ? "the file" : name_, problem);
}

JsonItem JsonItem::at(const std::string& key) const {
  if (auto item = find(key)) return *item;
  refuse("\"" + key + "\" is missing");
}

std::optional<JsonItem> JsonItem::find(const std::string& key) const {
  if (!value_->is_object()) refuse("is " + shown(*value_) + "; expected an object {...}");
  const auto found = value_->find(key);
  if (found == value_->end() || found->is_null()) return std::nullopt;
  return JsonItem(*file_, *found, name_.empty() ? key : name_ + "." + key);
}

JsonItem JsonItem::at(std::size_t index) const {
  if (index >= size()) refuse(fmt::format("has {} items; more are required", size()));
  return JsonItem(*file_, (*value_)[index], fmt::format("{}[{}]", name_, index));
}

std::size_t JsonItem::size() const {
  if (!value_->is_array()) refuse("is " + shown(*value_) + "; expected a list [...]");
  return value_->size();
}

std::string JsonItem::text() const {
  if (!value_->is_string()) refuse("is " + shown(*value_) + "; expected a text \"...\"");
  return value_->get<std::string>();
}

int JsonItem::integer(int low, int high) const {
  if (value_->is_number_integer()) {
    // Unsigned values above the signed range compare as doubles.
    const double n = value_->get<double>();
    if (n >= low && n <= high) return value_->get<int>();
  }
  refuse(fmt::format("is {}; expected a whole number from {} to {}", shown(*value_), low, high));
}

double JsonItem::number(double low, double high) const {
  if (value_->is_number()) {
    const double n = value_->get<double>();
    if (n >= low && n <= high) return n;
  }
  refuse(fmt::format("is {}; expected a number from {} to {}", shown(*value_), low, high));
}

void JsonItem::only_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) refuse("is not an object { ... }");
  for (const auto& [key, value] : value_->items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse(fmt::format("unknown key \"{}\"; valid keys are {}", key.substr(0, 40),
                         fmt::join(known, ", ")));
}

JsonFile::JsonFile(const std::filesystem::path& file, std::string_view text) : file_(file) {
  if (json_depth(text) > max_json_depth)
    throw InputError(file, "", "is nested deeper than any case or landmark list");
  try {
    value_ = nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    const auto at = std::min<std::size_t>(error.byte, text.size());
    const auto line =
        1 + std::count(text.begin(),
                       text.begin() + static_cast<std::ptrdiff_t>(at > 0 ? at - 1 : 0), '\n');
    throw InputError(file, fmt::format("line {}", line), "is not valid JSON: " + reason_of(error));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file, "", "is not valid JSON: " + reason_of(error));
  }
}

std::optional<std::filesystem::path> sidecar_of(const std::filesystem::path& file) {
  std::filesystem::path beside = file;
  beside += ".json";
  std::error_code ignored;
  if (!std::filesystem::exists(beside, ignored)) return std::nullopt;
  return beside;
}

}  // namespace condyle
