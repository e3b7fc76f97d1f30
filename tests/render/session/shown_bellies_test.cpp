// Bellies of muscles that a window shows while the plan is edited.
#include "render/session/shown_bellies.h"

#include <gtest/gtest.h>
#include <time.h>

#include <atomic>

#include "sim/muscles/default_muscles.h"
#include "sim/operated/operated_scene.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The built-in patient, and one whose muscles begin 1 mm farther to the left.
std::shared_ptr<const SessionPatient> session_patient(double moved_mm = 0) {
  Case patient = builtin_patient();
  auto muscles = muscles_of(patient);
  for (Muscle& muscle : muscles) muscle.origin.x() += moved_mm;
  Scene scene{.patient = patient, .contacts = ContactModel(patient, {}), .tissue = nullptr};
  return std::make_shared<const SessionPatient>(
      SessionPatient{.folder = {},
                     .scene = std::move(scene),
                     .muscles = std::move(muscles),
                     .operated = std::make_shared<const Operated>()});
}

std::vector<Eigen::Vector3f> places(const MuscleBellies& bellies) {
  FrameState rest;
  rest.poses = BodyPoses(std::vector<Pose>(2));
  std::vector<Eigen::Vector3f> all;
  for (std::size_t m = 0; m < bellies.muscles().size(); ++m)
    for (const auto& p : bellies.body(m, {}, rest).positions) all.push_back(p);
  return all;
}

TEST(ShownBellies, AreShapedOnAnotherThreadWhileTheLastOnesAreShown) {
  const auto before = session_patient(), edited = session_patient(1);
  const double begin_s = thread_cpu_s();
  const MuscleBellies of_before(before->muscles, before->scene.patient);
  const double shaping_s = thread_cpu_s() - begin_s;
  const auto places_before = places(of_before),
             places_edited = places({edited->muscles, edited->scene.patient});
  ASSERT_NE(places_before, places_edited);

  ViewState view;
  view.muscles.assign(before->muscles.size(), {.shown = false});
  std::atomic<int> news = 0;
  RetiredWork retired;
  ShownBellies shown(retired, [&news] { ++news, news.notify_all(); });
  double own_s = 0;
  const auto ask = [&](const auto& patient) {
    const double from_s = thread_cpu_s();
    auto given = shown.of(patient, view);
    own_s += thread_cpu_s() - from_s;
    return given;
  };
  /// Asks again at each news, until the bellies lie there.
  const auto wait_for = [&](const auto& patient, const auto& wanted, const auto& until_then) {
    while (true) {
      const int heard = news;
      const auto given = ask(patient);
      if (given && places(*given) == wanted) return given;
      EXPECT_EQ(given, until_then);
      news.wait(heard);
    }
  };
  EXPECT_EQ(ask(before), nullptr);
  EXPECT_EQ(news, 0) << "none are shaped while none are shown";
  view.muscles[3].shown = true;
  const std::shared_ptr<const MuscleBellies> none;
  const auto first = wait_for(before, places_before, none);
  const auto second = wait_for(edited, places_edited, first);
  // The stages of one edit share their bones, and their bellies.
  auto next_stage = *edited;
  const int heard = news;
  EXPECT_EQ(ask(std::make_shared<const SessionPatient>(next_stage)), second);
  EXPECT_EQ(news, heard);
  // Another patient's muscles are not drawn with these.
  auto another = *edited;
  another.muscles.pop_back();
  another.operated = std::make_shared<const Operated>();
  EXPECT_EQ(ask(std::make_shared<const SessionPatient>(another)), nullptr);
  view.muscles[3].shown = false;
  EXPECT_EQ(ask(edited), nullptr);
  std::printf("shaping %.0f ms, of the asking thread %.1f ms\n", 1e3 * shaping_s, 1e3 * own_s);
  EXPECT_LT(own_s, 0.1 * shaping_s);
}

}  // namespace
}  // namespace condyle
