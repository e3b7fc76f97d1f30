#include "sim/occlusion/bite_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double cell_mm = 0.35;  // loaded pieces in the same or adjacent cells are connected
constexpr double min_mark_mm2 = 0.02;

struct Cell {
  int upper = 0, lower = 0;
  bool left = false;  // a patch across the midline counts for both sides
  int x = 0, y = 0, z = 0;
  auto operator<=>(const Cell&) const = default;
};

struct Mark {
  ToothContact contact;
  double force_N = 0;
  Vector3d place = Vector3d::Zero(), normal = Vector3d::Zero();  // sums weighted by area
};

}  // namespace

int tooth_of(const Part& part, int triangle) {
  for (const auto& tooth : part.teeth)
    if (triangle >= tooth.first_triangle && triangle < tooth.first_triangle + tooth.triangle_count)
      return tooth.fdi;
  return 0;
}

std::vector<ToothContact> find_contacts(const Arches& arches, const BiteModel& model,
                                        const Pose& X_CM) {
  const Part &upper = *arches.upper.part, &lower = *arches.lower.part;
  const TriangleTree upper_tree(upper.mesh);
  const auto pressed = model.loaded_pieces(X_CM);
  std::map<Cell, std::vector<int>> cells;
  for (std::size_t i = 0; i < pressed.size(); ++i) {
    const auto& p = pressed[i].point;
    const auto number = [](double v) { return static_cast<int>(std::floor(v / cell_mm)); };
    const int triangle = model.lower_surface().pieces[pressed[i].piece].triangle;
    cells[{tooth_of(upper, upper_tree.nearest(p).triangle), tooth_of(lower, triangle),
           p.x() > arches.midline_mm, number(p.x()), number(p.y()), number(p.z())}]
        .push_back(static_cast<int>(i));
  }
  std::vector<Mark> marks;
  while (!cells.empty()) {
    Mark mark;
    mark.contact.upper_fdi = cells.begin()->first.upper;
    mark.contact.lower_fdi = cells.begin()->first.lower;
    mark.contact.left = cells.begin()->first.left;
    mark.contact.gap_mm = 1e300;
    std::vector<Cell> front = {cells.begin()->first};
    while (!front.empty()) {
      const Cell cell = front.back();
      front.pop_back();
      const auto found = cells.find(cell);
      if (found == cells.end()) continue;
      for (const int i : found->second) {
        const auto& piece = pressed[i];
        const double area = model.lower_surface().pieces[piece.piece].area_mm2;
        mark.contact.area_mm2 += area;
        mark.contact.gap_mm = std::min(mark.contact.gap_mm, piece.gap_mm);
        mark.force_N += piece.force_N;
        mark.place += area * (piece.point - piece.gap_mm * piece.gradient);
        mark.normal += area * piece.gradient;
      }
      cells.erase(found);
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dz = -1; dz <= 1; ++dz)
            front.push_back(
                {cell.upper, cell.lower, cell.left, cell.x + dx, cell.y + dy, cell.z + dz});
    }
    if (mark.contact.area_mm2 < min_mark_mm2) continue;
    mark.contact.place = mark.place / mark.contact.area_mm2;
    mark.contact.normal = mark.normal.normalized();
    marks.push_back(mark);
  }
  double all = 0;
  for (const auto& mark : marks) all += mark.force_N;
  std::stable_sort(marks.begin(), marks.end(),
                   [](const Mark& a, const Mark& b) { return a.force_N > b.force_N; });
  std::vector<ToothContact> contacts;
  for (auto& mark : marks) {
    mark.contact.load_fraction = mark.force_N / all;
    contacts.push_back(mark.contact);
  }
  return contacts;
}

std::vector<ToothLoad> tooth_loads(const Arches& arches,
                                   const std::vector<ToothContact>& contacts) {
  std::map<int, ToothLoad> loads;
  for (const auto* arch : {&arches.upper, &arches.lower})
    for (const auto& tooth : arch->part->teeth) loads[tooth.fdi].fdi = tooth.fdi;
  for (const auto& contact : contacts)
    for (const int fdi : {contact.upper_fdi, contact.lower_fdi}) {
      if (fdi == 0) continue;
      auto& load = loads[fdi];
      ++load.contacts;
      load.area_mm2 += contact.area_mm2;
      load.load_fraction += contact.load_fraction;
    }
  std::vector<ToothLoad> list;
  for (const auto& [fdi, load] : loads) list.push_back(load);
  return list;
}

}  // namespace condyle
