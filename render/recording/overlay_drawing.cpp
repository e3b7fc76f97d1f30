#include "render/recording/overlay_drawing.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/measure.h"
#include "sim/tissue/mesh_lines.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

// Okabe and Ito's colours, distinguishable with every kind of colour vision.
const Vector3f vermilion(.84f, .37f, 0), blue(0, .45f, .70f), sky(.34f, .71f, .91f),
    yellow(.94f, .89f, .26f), green(0, .62f, .45f), purple(.80f, .47f, .65f),
    white(.95f, .95f, .95f);

// For a spring at 0.5, 1 and 1.5 times its rest length.
const Vector3f shortened(.13f, .40f, .67f), rest(.86f, .86f, .86f), stretched(.80f, .20f, .16f);

Vector3f stretch_color(float stretch) {
  const float t = std::clamp((stretch - 1) / 0.5f, -1.f, 1.f);
  return t < 0 ? Vector3f(rest - t * (shortened - rest)) : Vector3f(rest + t * (stretched - rest));
}

LineSet springs(const Scene& scene, const FrameState& frame) {
  LineSet set{.width_px = 0.7f, .through = 0};
  for (const auto& spring : spring_lines(*scene.tissue, frame.tissue)) {
    set.ends.insert(set.ends.end(), spring.ends.begin(), spring.ends.end());
    set.colors.push_back(stretch_color(spring.stretch));
  }
  return set;
}

LineSet prisms(const Scene& scene, const FrameState& frame) {
  LineSet set{.color = green, .width_px = 0.9f, .through = 0};
  for (const auto& line : prism_lines(*scene.tissue, frame.tissue))
    set.ends.insert(set.ends.end(), line.begin(), line.end());
  return set;
}

LineSet bone_springs(const Scene& scene, const FrameState& frame, bool mandible) {
  LineSet set{
      .color = mandible ? vermilion : blue, .width_px = 2.5f, .dot_mm = 0.7f, .through = 0.35f};
  for (const auto& spring : bone_spring_lines(*scene.tissue, frame.tissue)) {
    if ((spring.moving_weight > 0.5) != mandible) continue;
    set.ends.insert(set.ends.end(), spring.ends.begin(), spring.ends.end());
    set.dots.push_back(spring.ends[1]);
  }
  return set;
}

/// Centre of all parts at rest.
Vector3f middle_of(const Scene& scene) {
  Box box;
  for (const auto& part : scene.patient.parts)
    for (const auto& v : part.mesh.vertices) box.add(v);
  return box.empty() ? Vector3f(0, 0, 0) : Vector3f(box.center().cast<float>());
}

LineSet axes(const Scene& scene, const Measures& m) {
  LineSet set{.width_px = 2.5f, .through = 0.6f};
  const auto color = [&](const Vector3f& c) { set.colors.resize(set.ends.size() / 2, c); };
  const auto& marks = scene.patient.landmarks;
  Vector3f from;
  if (marks.find("left_condyle") && marks.find("right_condyle")) {
    const Vector3f left = m.left_condyle.cast<float>(), right = m.right_condyle.cast<float>();
    const Vector3f across = (left - right).normalized();
    from = 0.5f * (left + right);
    set.ends.insert(set.ends.end(), {right - 25 * across, left + 25 * across});
    color(yellow);
  } else {
    from = middle_of(scene);
  }
  if (m.helical_axis.known) {
    const Vector3f p = m.helical_axis.point.cast<float>(),
                   d = m.helical_axis.direction.cast<float>();
    set.ends.insert(set.ends.end(), {p - 80 * d, p + 80 * d});
    color(purple);
  }
  constexpr float reach = 40;
  for (const auto& [unit, tint] :
       {std::pair{Vector3f::UnitX().eval(), vermilion}, std::pair{Vector3f::UnitY().eval(), green},
        std::pair{Vector3f::UnitZ().eval(), sky}}) {
    add_arrow(set, from, from + reach * unit);
    color(tint);
  }
  return set;
}

void extend(std::vector<Vector3f>& path, const Eigen::Vector3d& place) {
  constexpr float step_mm = 0.05f;
  const Vector3f p = place.cast<float>();
  if (path.empty() || (path.back() - p).norm() > step_mm) path.push_back(p);
}

}  // namespace

std::vector<KeyEntry> overlay_key(const OverlayChoice& choice, bool has_tissue) {
  using Mark = KeyEntry::Mark;
  std::vector<KeyEntry> key;
  const auto add = [&](bool shown, std::initializer_list<KeyEntry> entries) {
    if (shown) key.insert(key.end(), entries);
  };
  add(choice.paths, {{"Path of the lower incisors", {yellow, white}, Mark::path},
                     {"Path of the left condyle", {sky, white}, Mark::path},
                     {"Path of the right condyle", {vermilion, white}, Mark::path}});
  add(choice.axes, {{"Axis through both condyles", {yellow}},
                    {"Helical axis from rest", {purple}},
                    {"To the patient's left (L)", {vermilion}, Mark::arrow},
                    {"To the back (P)", {green}, Mark::arrow},
                    {"Up (S)", {sky}, Mark::arrow}});
  add(choice.springs && has_tissue,
      {{"Springs, 50 to 150 % long", {shortened, rest, stretched}, Mark::scale}});
  add(choice.prisms && has_tissue, {{"Edges of the prisms", {green}}});
  add(choice.bone_springs && has_tissue, {{"Springs to the mandible", {vermilion}, Mark::path},
                                          {"Springs to the skull", {blue}, Mark::path}});
  return key;
}

void MotionPaths::add(const Measures& measures) {
  extend(incisor_, measures.incisor);
  extend(left_, measures.left_condyle);
  extend(right_, measures.right_condyle);
}

LineSet MotionPaths::lines() const {
  LineSet set{.color = white, .width_px = 3, .dot_mm = 1.1f, .through = 0.7f};
  for (const auto& [path, color] :
       {std::pair{&incisor_, yellow}, std::pair{&left_, sky}, std::pair{&right_, vermilion}}) {
    add_run(set, *path);
    set.colors.resize(set.ends.size() / 2, color);
    if (!path->empty()) set.dots.push_back(path->back());
  }
  return set;
}

std::map<std::string, LineSet> overlay_lines(const Scene& scene, const FrameState& frame,
                                             const OverlayChoice& choice) {
  std::map<std::string, LineSet> all;
  if (scene.tissue && !frame.tissue.nodes.empty()) {
    if (choice.springs) all["springs"] = springs(scene, frame);
    if (choice.prisms) all["prisms"] = prisms(scene, frame);
    if (choice.bone_springs) {
      all["bone springs of the cranium"] = bone_springs(scene, frame, false);
      all["bone springs of the mandible"] = bone_springs(scene, frame, true);
    }
  }
  if (choice.axes) all["axes"] = axes(scene, frame.measures);
  return all;
}

}  // namespace condyle
