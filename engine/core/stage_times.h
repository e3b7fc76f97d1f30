#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace condyle {

/// The named stages of a frame, in the order in which they run.
enum class Stage : std::size_t { motion, contact, tissue, face, measures, render, count };
constexpr std::array<std::string_view, static_cast<std::size_t>(Stage::count)> stage_names = {
    "motion", "contact", "tissue", "face", "measures", "render"};

/// Wall time of each stage of one frame, ms.
struct StageTimes {
  std::array<double, static_cast<std::size_t>(Stage::count)> ms{};
  double& operator[](Stage stage) { return ms[static_cast<std::size_t>(stage)]; }
  double operator[](Stage stage) const { return ms[static_cast<std::size_t>(stage)]; }
};

/// Adds the lifetime of the object to one stage.
class StageTimer {
 public:
  StageTimer(StageTimes& times, Stage stage) : times_(times), stage_(stage) {}
  ~StageTimer() {
    times_[stage_] +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
            .count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimes& times_;
  Stage stage_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace condyle
