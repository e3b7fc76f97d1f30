#include "tools/bite_picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/mesh/measure.h"
#include "render/image/gap_colours.h"
#include "render/output/contact_picture.h"
#include "sim/report/occlusion_report.h"

namespace condyle {

Image bite_picture(const Case& patient, const Bite& bite, const BodyPoses& at, double film_mm,
                   int threads) {
  const BiteView view = bite_view(patient, bite, threads);
  const Eigen::Vector3d heaviest =
      bite.contacts.empty() ? bite.upper_edge : bite.contacts.front().place;
  Box arches;
  for (const auto& part : view.parts)
    if (part.name == bite.upper || part.name == bite.lower)
      for (const auto& p : part.mesh.vertices) arches.add(p);
  constexpr double border = 1.12;  // and a panel is a little narrower than high
  ContactView place{
      .parts = view.parts,
      .fixed = bite.upper,
      .moved = bite.lower,
      .fixed_values = view.upper_gap,
      .moved_values = view.lower_gap,
      .at = at,
      .place = heaviest,
      .middle = arches.center(),
      .normal = -bite.up,
      .seen_mm = border * std::max(arches.size().x(), arches.size().y()),
      .overview = "front",
      .title = "Settled bite: " + patient.name,
      .lines = {fmt::format("{} contacts at {:g} mm paper; load {:.0f} % left, {:.0f} % right; "
                            "overjet {:.1f} mm, overbite {:.1f} mm",
                            bite.contacts.size(), film_mm, 100 * bite.left_fraction,
                            bite.contacts.empty() ? 0.0 : 100 * (1 - bite.left_fraction),
                            bite.after.overjet_mm, bite.after.overbite_mm)}};
  return contact_picture(place, gap_colours(film_mm));
}

}  // namespace condyle
