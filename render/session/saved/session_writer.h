#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/session/saved/saved_session.h"

namespace condyle::session_fields {

using OrderedJson = nlohmann::ordered_json;

OrderedJson point_json(const Eigen::Vector3d& p);
OrderedJson pose_json(const Pose& pose);
/// Relative to the folder of `file` when it lies there.
std::string stored_path(const std::filesystem::path& path, const std::filesystem::path& file);

/// Puts the fields of a view into a JSON object.
class Writer {
 public:
  Writer(OrderedJson& object, const SavedSession& session, const std::filesystem::path& file)
      : object_(object), session_(session), file_(file) {}

  void flag(const char* name, bool value) { object_[name] = value; }
  void number(const char* name, double value, double, double) { object_[name] = value; }
  void number(const char* name, const std::optional<double>& value, double, double) {
    if (value) object_[name] = *value;
  }
  void index(const char* name, std::size_t value, std::size_t) { object_[name] = value; }
  void index(const char* name, const std::optional<std::size_t>& value, std::size_t) {
    if (value) object_[name] = *value;
  }
  void text(const char* name, const std::string& value) { object_[name] = value; }
  void letter(const char* name, char value, const char*) { object_[name] = std::string(1, value); }
  template <class Choice, std::size_t n>
  void choice(const char* name, Choice value, const std::array<const char*, n>& known) {
    object_[name] = known.at(static_cast<std::size_t>(value));
  }
  template <class Fields>
  void group(const char* name, const Fields& fields) {
    object_[name] = OrderedJson::object();
    Writer inside(object_[name], session_, file_);
    fields(inside);
  }
  void name(const char* name, std::string ViewNames::*which) {
    object_[name] = session_.names.*which;
  }
  void names(const char* name, std::vector<std::string> ViewNames::*which) {
    object_[name] = session_.names.*which;
  }
  void parts(const char* name, const std::vector<PartView>& views,
             std::vector<std::string> ViewNames::*which);
  void points(const char* name, const std::vector<PinnedPoint>& points);
  void hands(const char* name, const Hands& hands);
  void landmarks(const char* name, const std::vector<Landmark>& landmarks);
  void cut(const char* name, const DrawnCut& cut);
  void part(const char* name, const std::optional<std::size_t>& part) {
    if (part) object_[name] = part_name(*part);
  }
  void motion(const char* name, const MotionChoice& motion);
  void expression(const char* name, const std::vector<ExpressionLevel>& levels);

 private:
  std::string part_name(std::size_t part) const;

  OrderedJson& object_;
  const SavedSession& session_;
  const std::filesystem::path& file_;
};

}  // namespace condyle::session_fields
