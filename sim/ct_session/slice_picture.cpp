#include "sim/ct_session/slice_picture.h"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "sim/ct_session/slice_outlines.h"

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;

constexpr double black_hu = -500, white_hu = 1500;
constexpr double picture_side = 768;  // about so many pixels on the longer side
constexpr int most_enlarged = 8;

/// How often a value is repeated, so that the picture is fine enough for outlines.
struct Enlarged {
  int x = 1, y = 1;
};

Enlarged enlargement(const SliceValues& slice) {
  const double wide = slice.right.norm(), high = slice.down.norm();
  const double pixel_mm = std::max(slice.width * wide, slice.height * high) / picture_side;
  const auto times = [&](double mm) {
    return std::clamp(static_cast<int>(std::lround(mm / pixel_mm)), 1, most_enlarged);
  };
  return {times(wide), times(high)};
}

/// Value between the centres of pixels.
float between(const SliceValues& slice, float x, float y) {
  x = std::clamp(x, 0.f, static_cast<float>(slice.width - 1));
  y = std::clamp(y, 0.f, static_cast<float>(slice.height - 1));
  const int i = std::min(static_cast<int>(x), std::max(0, slice.width - 2)),
            j = std::min(static_cast<int>(y), std::max(0, slice.height - 2));
  const float u = x - static_cast<float>(i), v = y - static_cast<float>(j);
  const auto at = [&](int a, int b) {
    a = std::min(a, slice.width - 1), b = std::min(b, slice.height - 1);
    return static_cast<float>(
        slice.values[static_cast<std::size_t>(b) * static_cast<std::size_t>(slice.width) +
                     static_cast<std::size_t>(a)]);
  };
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
         v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

void draw_grey(const SliceValues& slice, const Enlarged& times, CtPixels& picture, int threads) {
  parallel_for(static_cast<std::size_t>(picture.height), threads, [&](std::size_t row) {
    std::uint8_t* out = &picture.rgba[row * static_cast<std::size_t>(picture.width) * 4];
    const float y = (static_cast<float>(row) + 0.5f) / static_cast<float>(times.y) - 0.5f;
    for (int column = 0; column < picture.width; ++column) {
      const float x = (static_cast<float>(column) + 0.5f) / static_cast<float>(times.x) - 0.5f;
      const double light = (between(slice, x, y) - black_hu) / (white_hu - black_hu);
      const auto grey = static_cast<std::uint8_t>(std::lround(255 * std::clamp(light, 0.0, 1.0)));
      for (int c = 0; c < 3; ++c) *out++ = grey;
      *out++ = 255;
    }
  });
}

float distance_to(const OutlinePiece& piece, const Vector2f& p) {
  const Vector2f along = piece[1] - piece[0];
  const float length2 = along.squaredNorm();
  const float t = length2 > 0 ? std::clamp((p - piece[0]).dot(along) / length2, 0.f, 1.f) : 0.f;
  return (p - piece[0] - t * along).norm();
}

void draw_outline(const std::vector<OutlinePiece>& pieces, const Enlarged& times,
                  const std::array<std::uint8_t, 3>& tint, CtPixels& picture) {
  constexpr float half = 0.9f;  // of the line's width, pixels
  std::vector<float> covered(picture.rgba.size() / 4, 0);
  const auto scaled = [&](const Vector2f& p) {
    return Vector2f((p.x() + 0.5f) * static_cast<float>(times.x) - 0.5f,
                    (p.y() + 0.5f) * static_cast<float>(times.y) - 0.5f);
  };
  for (const OutlinePiece& piece : pieces) {
    const OutlinePiece line = {scaled(piece[0]), scaled(piece[1])};
    const Vector2f low = line[0].cwiseMin(line[1]), high = line[0].cwiseMax(line[1]);
    const auto first = [](float v) { return std::max(0, static_cast<int>(v - half)); };
    const auto last = [](float v, int size) {
      return std::min(size - 1, static_cast<int>(std::ceil(v + half)));
    };
    for (int y = first(low.y()); y <= last(high.y(), picture.height); ++y)
      for (int x = first(low.x()); x <= last(high.x(), picture.width); ++x) {
        const float away = distance_to(line, {static_cast<float>(x), static_cast<float>(y)});
        float& most =
            covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                    static_cast<std::size_t>(x)];
        most = std::max(most, std::clamp(half + 0.5f - away, 0.f, 1.f));
      }
  }
  for (std::size_t i = 0; i < covered.size(); ++i)
    for (std::size_t c = 0; covered[i] > 0 && c < 3; ++c) {
      std::uint8_t& value = picture.rgba[4 * i + c];
      value = static_cast<std::uint8_t>(
          std::lround(static_cast<float>(value) +
                      covered[i] * (static_cast<float>(tint[c]) - static_cast<float>(value))));
    }
}

/// "L" for a direction to the patient's left, and so on.
std::string letter_of(const Vector3d& direction) {
  int most = 0;
  direction.cwiseAbs().maxCoeff(&most);
  return std::string(1, (direction[most] > 0 ? "LPS" : "RAI")[most]);
}

}  // namespace

CtSliceView draw_slice(const Volume& volume, SliceSide side, const Vector3d& point,
                       const SliceLevels& levels, int threads) {
  const SliceValues slice = slice_through(volume, side, point);
  const Enlarged times = enlargement(slice);
  auto picture = std::make_shared<CtPixels>();
  picture->width = slice.width * times.x;
  picture->height = slice.height * times.y;
  picture->rgba.resize(static_cast<std::size_t>(picture->width) *
                       static_cast<std::size_t>(picture->height) * 4);
  draw_grey(slice, times, *picture, threads);
  const std::vector<float> smooth = smooth_values(slice);
  draw_outline(outer_outlines(smooth, slice.width, slice.height, levels.skin), times,
               {0x56, 0xb4, 0xe9}, *picture);
  draw_outline(outlines(smooth, slice.width, slice.height, levels.bone), times, {0xf0, 0xe4, 0x42},
               *picture);

  constexpr const char* names[] = {"Axial", "Coronal", "Sagittal"};
  CtSliceView view;
  view.name = names[static_cast<std::size_t>(side)];
  view.picture = std::move(picture);
  view.width_mm = slice.width * slice.right.norm();
  view.height_mm = slice.height * slice.down.norm();
  view.corner = slice.corner - 0.5 * (slice.right + slice.down);
  view.right = slice.right.normalized();
  view.down = slice.down.normalized();
  view.step = slice.step;
  view.sides = {letter_of(-slice.right), letter_of(slice.right), letter_of(-slice.down),
                letter_of(slice.down)};
  view.number = slice.number + 1;
  view.count = slice.count;
  return view;
}

}  // namespace condyle
