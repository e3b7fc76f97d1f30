#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/session/saved/saved_session.h"
#include "sim/case/json_file.h"

namespace condyle::session_fields {

Eigen::Vector3d point_in(const JsonItem& item);
Pose pose_in(const JsonItem& item);
bool flag_in(const JsonItem& item);
/// A path of a session file, absolute.
std::filesystem::path path_in(const JsonItem& item, const std::filesystem::path& file);
/// Number of a name in a list. throws: InputError at the item.
std::size_t number_of(const std::vector<std::string>& names, const JsonItem& item);

/// Takes the fields of a view from a JSON object. A missing one keeps its value; after the last
/// one, end() refuses those that are unknown.
class Reader {
 public:
  Reader(const JsonItem& object, SavedSession& session, const std::filesystem::path& file)
      : object_(object), session_(session), file_(file) {}
  void end() const;

  void flag(const char* name, bool& value) {
    if (const auto item = find(name)) value = flag_in(*item);
  }
  void number(const char* name, double& value, double low, double high) {
    if (const auto item = find(name)) value = item->number(low, high);
  }
  void number(const char* name, std::optional<double>& value, double low, double high) {
    if (const auto item = find(name)) value = item->number(low, high);
  }
  template <class Index>  // a number, or an optional one
  void index(const char* name, Index& value, int most) {
    if (const auto item = find(name)) value = static_cast<std::size_t>(item->integer(0, most));
  }
  void text(const char* name, std::string& value) {
    if (const auto item = find(name)) value = item->text();
  }
  void letter(const char* name, char& value, const std::string& known);
  template <class Choice, std::size_t n>
  void choice(const char* name, Choice& value, const std::array<const char*, n>& known) {
    const auto item = find(name);
    if (item) value = static_cast<Choice>(number_of({known.begin(), known.end()}, *item));
  }
  template <class Fields>
  void group(const char* name, const Fields& fields) {
    const auto item = find(name);
    if (!item) return;
    Reader inside(*item, session_, file_);
    fields(inside);
    inside.end();
  }
  void name(const char* name, std::string ViewNames::*which) {
    if (const auto item = find(name)) session_.names.*which = item->text();
  }
  void names(const char* name, std::vector<std::string> ViewNames::*which);
  void parts(const char* name, std::vector<PartView>& views,
             std::vector<std::string> ViewNames::*which);
  void points(const char* name, std::vector<PinnedPoint>& points);
  void hands(const char* name, Hands& hands);
  void landmarks(const char* name, std::vector<Landmark>& landmarks);
  void cut(const char* name, DrawnCut& cut);
  void part(const char* name, std::optional<std::size_t>& part) {
    if (const auto item = find(name)) part = part_in(*item);
  }
  void motion(const char* name, MotionChoice& motion);
  void expression(const char* name, std::vector<ExpressionLevel>& levels);

 private:
  std::optional<JsonItem> find(const char* name);
  std::size_t part_in(const JsonItem& item) const;  // its number

  JsonItem object_;
  SavedSession& session_;
  const std::filesystem::path& file_;
  std::vector<std::string> known_;
};

}  // namespace condyle::session_fields
