#include "sim/osteotomy/vault.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double degree = 3.14159265358979323846 / 180;
constexpr double far_mm = 250, default_thickness_mm = 7;

double frankfort_height(const SurgicalAnatomy& skull) {
  for (const char* paired : {"porion", "orbitale"})
    if (const auto p = skull.find_middle(paired)) return p->z();
  return skull.need("nasion").z() - 26;
}

}  // namespace

Vault::Vault(SurgicalAnatomy& skull) : tree_(skull.bone()) {
  find_middle(skull);
  find_midline(skull);
}

/// Between the front and back of what lies 30 mm above the Frankfort plane, and 0.38 of the way up
/// from that plane.
void Vault::find_middle(const SurgicalAnatomy& skull) {
  const double level = frankfort_height(skull);
  Box box;
  for (const Vector3d& p : skull.bone().vertices)
    if (p.z() > level + 30) box.add(p);
  if (box.empty() || box.high.y() - box.low.y() < 80 || box.high.x() - box.low.x() < 60)
    throw InputError("the skull has no vault: too little bone 30 mm above the Frankfort plane");
  middle_ = {0, 0.5 * (box.low.y() + box.high.y()), level + 0.38 * (box.high.z() - level)};
}

/// The outermost bone on a ray; thickness to the next surface within it.
Vault::Spot Vault::probe(const Vector3d& from, const Vector3d& direction) const {
  const auto outer = tree_.ray_cast(from + far_mm * direction, -direction, far_mm - 20);
  if (!outer) return {};
  const auto inner = tree_.ray_cast(outer->point - 0.3 * direction, -direction, 20);
  return {outer->point, inner ? 0.3 + inner->distance : default_thickness_mm, true};
}

/// Spots of rays from one point at equal angles, and their distances along the surface. In a gap
/// the radius lies between those of its rims.
void Vault::fill_gaps(std::vector<Station>& stations, const Vector3d& from,
                      const std::vector<Vector3d>& directions) const {
  const int count = static_cast<int>(directions.size());
  std::vector<double> radius(directions.size(), -1);
  double last = -1;
  for (int i = 0; i < count; ++i) {
    stations.push_back({0, probe(from, directions[i])});
    if (!stations[i].spot.has_bone) continue;
    radius[i] = (stations[i].spot.at - from).norm();
    // Seen through a gap is the base of the skull.
    if (last > 0 && radius[i] < 0.7 * last)
      radius[i] = -1, stations[i].spot.has_bone = false;
    else
      last = radius[i];
  }
  for (int i = 0; i < count; ++i) {
    if (radius[i] > 0) continue;
    int low = i - 1, high = i + 1;
    while (high < count && radius[high] < 0) ++high;
    if (low < 0 && high == count) throw InputError("the skull has no vault where it is to be cut");
    const double before = low >= 0 ? radius[low] : radius[high],
                 after = high < count ? radius[high] : before;
    const double between = before + (after - before) / (high - low);
    stations[i].spot = {from + between * directions[i], default_thickness_mm, false};
    radius[i] = between;
  }
  for (int i = 1; i < count; ++i)
    stations[i].distance =
        stations[i - 1].distance + (stations[i].spot.at - stations[i - 1].spot.at).norm();
}

void Vault::find_midline(SurgicalAnatomy& skull) {
  const Vector3d nasion = skull.need("nasion") - middle_;
  const double first = std::atan2(nasion.z(), -nasion.y()) / degree;
  std::vector<Vector3d> directions;
  for (double angle = first; angle < 205; angle += 1)
    directions.push_back({0, -std::cos(angle * degree), std::sin(angle * degree)});
  fill_gaps(midline_, middle_, directions);
  const auto rear = std::max_element(
      midline_.begin(), midline_.end(),
      [](const Station& a, const Station& b) { return a.spot.at.y() < b.spot.at.y(); });
  const auto along = [&](const char* name, double fraction) {
    const auto landmark = skull.find(name);
    if (!landmark) {
      skull.notes.push_back(std::string(name) +
                            " is estimated from the midline between nasion and the rearmost point");
      return fraction * rear->distance;
    }
    return std::min_element(midline_.begin(), midline_.end(),
                            [&](const Station& a, const Station& b) {
                              return (a.spot.at - *landmark).norm() <
                                     (b.spot.at - *landmark).norm();
                            })
        ->distance;
  };
  bregma_ = along("bregma", 0.45);
  lambda_ = along("lambda", 0.89);
  if (lambda_ < bregma_ + 40) throw InputError("lambda lies less than 40 mm behind bregma");
}

/// Half an arch over the vault in a plane that contains the axis to the left. The planes of all
/// arches meet 100 mm below the middle: arches fan out slightly.
const std::vector<Vault::Station>& Vault::arch(double along, Side side) {
  auto& stations = arches_[{along, side}];
  if (!stations.empty()) return stations;
  const Vector3d top = at_distance(midline_, along).at, foot = middle_ - Vector3d(0, 0, 100);
  if (top.z() < middle_.z() + 10)
    throw InputError("a border of the panels is too far to the front or back of the vault");
  const Vector3d from = top + (top.z() - middle_.z()) / (top.z() - foot.z()) * (foot - top);
  const Vector3d up = (top - from).normalized(), out(sign_of(side), 0, 0);
  std::vector<Vector3d> directions;
  for (double angle = 0; angle < 115; angle += 1)
    directions.push_back(std::cos(angle * degree) * up + std::sin(angle * degree) * out);
  fill_gaps(stations, from, directions);
  return stations;
}

Vault::Spot Vault::at_distance(const std::vector<Station>& stations, double distance) {
  const auto next =
      std::lower_bound(stations.begin(), stations.end(), distance,
                       [](const Station& station, double d) { return station.distance < d; });
  if (next == stations.begin()) return next->spot;
  if (next == stations.end()) return stations.back().spot;
  const Station &a = *(next - 1), &b = *next;
  const double t = (distance - a.distance) / (b.distance - a.distance);
  Spot spot = t < 0.5 ? a.spot : b.spot;
  spot.at = (1 - t) * a.spot.at + t * b.spot.at;
  return spot;
}

Vault::Spot Vault::spot(double along, double beside) {
  if (beside == 0) return at_distance(midline_, along);
  return at_distance(arch(along, beside < 0 ? Side::right : Side::left), std::abs(beside));
}

std::optional<double> Vault::last_gap(double along, Side side, double limit_mm) {
  std::optional<double> last;
  for (const Station& station : arch(along, side))
    if (!station.spot.has_bone && station.distance < limit_mm) last = station.distance;
  return last;
}

VaultBorder vault_border(const Vault& vault, const Vector3d& a, const Vector3d& b,
                         const Vector3d& inside) {
  const Vector3d middle = 0.5 * (a + b);
  Vector3d inward = (b - a).cross(vault.outward(middle)).normalized();
  if (inward.dot(inside - middle) < 0) inward = -inward;
  return {middle, inward};
}

Cut panel_cut(const SurgicalAnatomy& skull, const Vault& vault, const std::string& name,
              const std::vector<VaultBorder>& borders, const std::vector<Vault::Spot>& spots) {
  Vector3d normal = Vector3d::Zero();
  for (const auto& spot : spots) normal += vault.outward(spot.at);
  normal.normalize();
  double low = 1e9, high = -1e9;
  for (const auto& spot : spots) {
    high = std::max(high, normal.dot(spot.at));
    low = std::min(low, normal.dot(spot.at) - spot.thickness_mm);
  }
  std::vector<Plane> reach = {skull.plane((high + vault_reach_mm) * normal, normal),
                              skull.plane((low - vault_reach_mm) * normal, -normal)};
  std::optional<Region> panel;
  int wall = 0;
  for (const VaultBorder& border : borders) {
    const double beyond = border.is_shared ? 0 : vault_reach_mm;
    reach.push_back(skull.plane(border.point - beyond * border.inward, -border.inward));
    if (border.is_shared) continue;
    Region half = skull.above(border.point, border.inward, wall++);
    panel = panel ? both(std::move(*panel), std::move(half)) : std::move(half);
  }
  return {name, std::move(*panel), std::move(reach), 0};
}

}  // namespace condyle
