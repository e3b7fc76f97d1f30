#include "render/session/saved/session_writer.h"

namespace condyle::session_fields {

namespace fs = std::filesystem;

OrderedJson point_json(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

OrderedJson pose_json(const Pose& pose) {
  return {{"rotation", {pose.R.w(), pose.R.x(), pose.R.y(), pose.R.z()}},
          {"translation_mm", point_json(pose.t)}};
}

std::string stored_path(const fs::path& path, const fs::path& file) {
  if (path.empty()) return {};
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored).lexically_normal();
  const fs::path folder = fs::absolute(file, ignored).lexically_normal().parent_path();
  const fs::path relative = whole.lexically_relative(folder);
  if (relative.empty() || *relative.begin() == "..") return whole.string();
  return relative.string();
}

std::string Writer::part_name(std::size_t part) const {
  return part < session_.names.parts.size() ? session_.names.parts[part] : "";
}

void Writer::parts(const char* name, const std::vector<PartView>& views,
                   std::vector<std::string> ViewNames::*which) {
  const std::vector<std::string>& names = session_.names.*which;
  OrderedJson& list = object_[name] = OrderedJson::array();
  for (std::size_t i = 0; i < views.size() && i < names.size(); ++i) {
    const auto& [shown, opacity] = views[i];  // complete: a new field does not compile
    list.push_back({{"name", names[i]}, {"shown", shown}, {"opacity", opacity}});
  }
}

void Writer::points(const char* name, const std::vector<PinnedPoint>& points) {
  OrderedJson& list = object_[name] = OrderedJson::array();
  for (std::size_t i = 0; i < points.size() && i < session_.measured_at_rest.size(); ++i) {
    const auto& [part, triangle, barycentric] = points[i];
    list.push_back({{"part", part_name(part)},
                    {"triangle", {triangle.x(), triangle.y(), triangle.z()}},
                    {"barycentric", point_json(barycentric)},
                    {"at_rest_mm", point_json(session_.measured_at_rest[i])}});
  }
}

void Writer::hands(const char* name, const Hands& hands) {
  const auto& [X_PB, X_RM, jaw] = hands;
  const auto& bodies = session_.names.bodies;
  OrderedJson targets = OrderedJson::array();
  for (std::size_t i = 0; i < X_PB.size() && i < bodies.size(); ++i)
    if (X_PB[i] && !bodies[i].empty())
      targets.push_back({{"body", bodies[i]}, {"pose", pose_json(*X_PB[i])}});
  object_[name] = {{"targets", targets}};
  if (index_of(jaw) < bodies.size()) object_[name]["jaw"] = bodies[index_of(jaw)];
  if (X_RM) object_[name]["jaw_in_room"] = pose_json(*X_RM);
}

void Writer::landmarks(const char* name, const std::vector<Landmark>& landmarks) {
  OrderedJson& list = object_[name] = OrderedJson::array();
  for (const Landmark& one : landmarks) {
    const auto& [landmark, at_rest, part, vertex] = one;
    list.push_back({{"name", landmark},
                    {"at_rest_mm", point_json(at_rest)},
                    {"part", part_name(part)},
                    {"vertex", vertex}});
  }
}

void Writer::cut(const char* name, const DrawnCut& cut) {
  const auto& [part, points, direction, depth_mm, kerf_mm] = cut;
  OrderedJson& item = object_[name] = OrderedJson::object();
  if (part) item["part"] = part_name(*part);
  item["points_mm"] = OrderedJson::array();
  for (const Eigen::Vector3d& point : points) item["points_mm"].push_back(point_json(point));
  item["direction"] = point_json(direction);
  item["depth_mm"] = depth_mm;
  item["kerf_mm"] = kerf_mm;
}

void Writer::motion(const char* name, const MotionChoice& motion) {
  const auto& [spec, parameters, excitations] = motion;
  OrderedJson& item = object_[name] = OrderedJson::object();
  const std::size_t colon = spec.find(':');
  const std::size_t start =
      spec.starts_with("muscles:") || spec.starts_with("inverse:") ? colon + 1 : 0;
  std::error_code ignored;
  if (fs::is_regular_file(spec.substr(start), ignored)) {
    if (start > 0) item["kind"] = spec.substr(0, start - 1);
    item["file"] = stored_path(spec.substr(start), file_);
  } else {
    item["spec"] = spec;
  }
  item["parameters"] = parameters;
  item["excitations"] = excitations;
}

void Writer::expression(const char* name, const std::vector<ExpressionLevel>& levels) {
  OrderedJson& list = object_[name] = OrderedJson::array();
  for (const auto& [expression, left, right] : levels)
    list.push_back({{"name", expression}, {"left", left}, {"right", right}});
}

}  // namespace condyle::session_fields
