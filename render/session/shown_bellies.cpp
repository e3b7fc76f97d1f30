#include "render/session/shown_bellies.h"

#include <algorithm>
#include <utility>

#include "render/session/view_overlays.h"

namespace condyle {
namespace {

bool are_same_muscles(const std::vector<Muscle>& a, const std::vector<Muscle>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Muscle& one, const Muscle& other) { return one.name == other.name; });
}

}  // namespace

std::shared_ptr<const MuscleBellies> ShownBellies::of(
    const std::shared_ptr<const SessionPatient>& patient, const ViewState& view) {
  if (!shows_muscles(view)) return nullptr;
  // The stages of an edited plan are patients with the same bones.
  if (shaped_for_ != patient->operated) {
    shaped_for_ = patient->operated;
    job_.start([patient](const Progress& progress) {
      return std::make_shared<const MuscleBellies>(patient->muscles, patient->scene.patient,
                                                   progress);
    });
  }
  if (job_.done())
    if (auto made = job_.take()) ready_ = std::move(*made);
  return ready_ && are_same_muscles(ready_->muscles(), patient->muscles) ? ready_ : nullptr;
}

}  // namespace condyle
