#include "sim/phantom/head_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Variant = HeadChoice::Variant;
constexpr std::array variant_names = {std::pair{"standard", Variant::standard},
                                      std::pair{"class-iii", Variant::class_iii},
                                      std::pair{"scaphocephaly", Variant::scaphocephaly}};
constexpr const char* base_name = "built-in";
constexpr double limit_sd = 1.8;

/// One dimension that varies between healthy adults.
struct Variation {
  double HeadShape::*dimension;
  double sd;
};

// Soft faces: DOI 10.1186/s40902-019-0191-7, table 9, mean of the standard deviations of men and
// women: zy-zy 4.0, go-go 4.4, n-sn 2.5, sn-me 4.2 (about half of it below the lower arch), al-al
// 3.8. Mandibular length (Co-Gn 6.0) and midface (Co-A 5.2): McNamara 1984, of which size as a
// whole, which does not vary here, is the larger part; the rest gives SNA and SNB their spread
// (3 to 3.5, Steiner 1953): how it is divided among chin, gonion and maxilla is our choice. Overjet
// 1: textbook. Cant: Padwa et al. 1997 state that one below 4 degrees is rarely noticed; its
// standard deviation is our choice. Vault: Gordon et al. 1989, men, head breadth 5.4, length 7.1;
// height our choice. Nose: sn-prn 2, Farkas 1994.
constexpr std::array variations = {
    Variation{&HeadShape::face_width, 4.0},      Variation{&HeadShape::gonial_width, 4.4},
    Variation{&HeadShape::upper_height, 2.0},    Variation{&HeadShape::chin_down, 2.0},
    Variation{&HeadShape::chin_forward, 1.5},    Variation{&HeadShape::gonion_down, 2.0},
    Variation{&HeadShape::maxilla_forward, 2.0}, Variation{&HeadShape::bite_forward, 0.7},
    Variation{&HeadShape::cant_deg, 0.8},        Variation{&HeadShape::nose_forward, 1.5},
    Variation{&HeadShape::nose_width, 2.0},      Variation{&HeadShape::vault_width, 5.4},
    Variation{&HeadShape::vault_length, 7.1},    Variation{&HeadShape::vault_height, 3.5}};

/// SplitMix64 (Steele et al. 2014).
class Generator {
 public:
  explicit Generator(std::uint64_t seed) : state_(seed) {}

  /// About normal, by the sum of 12 uniform numbers: arithmetic alone, equal on every machine.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(next() >> 11) * 0x1p-53;
    return sum;
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

/// Class III: a long lower jaw with an obtuse angle under an upper jaw that is slightly too far
/// back.
void make_class_iii(HeadShape& shape) {
  shape.maxilla_forward -= 1.2;
  shape.bite_forward = 9.2;  // from an overjet of 2.7 mm to -6.5
  shape.gonion_forward += 1.5;
  shape.chin_forward -= 0.5;
  shape.chin_down += 1;
}

/// Long, narrow, with a ridge along the suture, bossed in front and behind: the cephalic index of
/// the bone is below 70, our choice. The look follows the AO Surgery Reference, sagittal
/// synostosis, and an adult skull (Skrzat et al., Folia Morphologica 2014;73:92-98).
void make_scaphocephaly(HeadShape& shape) {
  shape.vault_width = std::min(shape.vault_width, 0.0) * 0.5 - 14;
  shape.vault_length = std::max(shape.vault_length, 0.0) * 0.5 + 11;
  shape.forehead_forward += 4;
  shape.sagittal_ridge += 3.5;
}

}  // namespace

std::string head_variant_names() {
  std::string names;
  for (const auto& [name, variant] : variant_names)
    names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

HeadChoice::Variant head_variant(const std::string& name) {
  for (const auto& [known, variant] : variant_names)
    if (name == known) return variant;
  throw InputError("variant " + name + ": unknown; known are " + head_variant_names());
}

bool is_head_name(const std::string& name) {
  return name == base_name || name.starts_with(std::string(base_name) + ":");
}

HeadChoice parse_head_name(const std::string& name) {
  HeadChoice choice;
  for (std::size_t start = name.find(':'); start != std::string::npos;) {
    const std::size_t end = name.find(':', start + 1);
    const std::string word = name.substr(start + 1, end - start - 1);
    start = end;
    if (!word.starts_with("seed=")) {
      try {
        choice.variant = head_variant(word);
      } catch (const InputError& error) {
        throw InputError(name + ": " + error.what() + ", seed=NUMBER");
      }
      continue;
    }
    const char* const last = word.data() + word.size();
    const auto [stop, problem] = std::from_chars(word.data() + 5, last, choice.seed);
    if (problem != std::errc() || stop != last)
      throw InputError(name + ": " + word + ": must be a whole number, 0 or more");
  }
  return choice;
}

std::string head_name(const HeadChoice& choice) {
  std::string name = base_name;
  for (const auto& [known, variant] : variant_names)
    if (variant == choice.variant && variant != Variant::standard) name += std::string(":") + known;
  if (choice.seed != 0) name += fmt::format(":seed={}", choice.seed);
  return name;
}

HeadShape head_shape(const HeadChoice& choice) {
  HeadShape shape;
  if (choice.seed != 0) {
    Generator generator(choice.seed);
    for (const auto& [dimension, sd] : variations)
      shape.*dimension = sd * std::clamp(generator.normal(), -limit_sd, limit_sd);
  }
  if (choice.variant == Variant::class_iii) make_class_iii(shape);
  if (choice.variant == Variant::scaphocephaly) make_scaphocephaly(shape);
  return shape;
}

}  // namespace condyle
