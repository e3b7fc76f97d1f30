#include "sim/plan/move_words.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "sim/case/landmark_names.h"

namespace condyle {
namespace {

/// A word of a move, the value that it sets, and the sense.
struct MoveKeyword {
  const char* word;
  double ClinicalMove::*value;
  double sign;
};
constexpr std::array keywords = {MoveKeyword{"left", &ClinicalMove::left_mm, 1},
                                 MoveKeyword{"right", &ClinicalMove::left_mm, -1},
                                 MoveKeyword{"forward", &ClinicalMove::forward_mm, 1},
                                 MoveKeyword{"advance", &ClinicalMove::forward_mm, 1},
                                 MoveKeyword{"back", &ClinicalMove::forward_mm, -1},
                                 MoveKeyword{"setback", &ClinicalMove::forward_mm, -1},
                                 MoveKeyword{"up", &ClinicalMove::up_mm, 1},
                                 MoveKeyword{"impact", &ClinicalMove::up_mm, 1},
                                 MoveKeyword{"down", &ClinicalMove::up_mm, -1},
                                 MoveKeyword{"extrude", &ClinicalMove::up_mm, -1},
                                 MoveKeyword{"pitch", &ClinicalMove::pitch_deg, 1},
                                 MoveKeyword{"roll", &ClinicalMove::roll_deg, 1},
                                 MoveKeyword{"cant", &ClinicalMove::roll_deg, 1},
                                 MoveKeyword{"yaw", &ClinicalMove::yaw_deg, 1}};

const MoveKeyword* keyword_named(const std::string& word) {
  for (const MoveKeyword& each : keywords)
    if (word == each.word) return &each;
  return nullptr;
}

/// The words without commas.
std::vector<std::string> parts_of(std::span<const std::string> words) {
  std::vector<std::string> parts;
  for (const std::string& word : words) {
    std::string part;
    for (const char c : word + " ")
      if (c != ' ' && c != ',' && c != ';')
        part += c;
      else if (!part.empty())
        parts.push_back(std::exchange(part, {}));
  }
  return parts;
}

double number_after(const std::vector<std::string>& words, std::size_t at) {
  if (at + 1 >= words.size())
    throw InputError(
        fmt::format("\"{}\" needs a number after it, as in \"{} 2\"", words[at], words[at]));
  char* end = nullptr;
  const double value = std::strtod(words[at + 1].c_str(), &end);
  if (end == words[at + 1].c_str() || *end != '\0' || !std::isfinite(value))
    throw InputError(
        fmt::format("\"{} {}\": \"{}\" is not a number", words[at], words[at + 1], words[at + 1]));
  return value;
}

/// A landmark by any of its names, canonical.
std::string point_named(const std::string& word) {
  if (word == "centroid") return word;
  const std::string name = canonical_landmark(word);
  if (name.empty()) throw InputError("\"" + word + "\" is no name of a point");
  return name;
}

[[noreturn]] void refuse_move_word(const std::string& word) {
  std::vector<std::string> known = {"about"};
  for (const MoveKeyword& each : keywords) known.emplace_back(each.word);
  throw InputError(fmt::format(
      "\"{}\" is no word of a move{}; they are {}, each with a number, \"about POINT\", and "
      "\"POINT up MM\" for the height of a second point",
      word, suggestion(word, known), fmt::join(known.begin() + 1, known.end(), ", ")));
}

}  // namespace

WrittenMove parse_move_words(std::span<const std::string> given) {
  const std::vector<std::string> words = parts_of(given);
  WrittenMove written;
  std::vector<double ClinicalMove::*> set;
  for (std::size_t i = 0; i < words.size();) {
    if (words[i] == "about") {
      if (i + 1 >= words.size()) throw InputError("\"about\" needs the name of a point after it");
      if (!written.move.about.empty()) throw InputError("\"about\" is given twice");
      written.move.about = point_named(words[i + 1]);
      i += 2;
    } else if (const MoveKeyword* keyword = keyword_named(words[i])) {
      for (const auto value : set)
        if (value == keyword->value)
          throw InputError(fmt::format("\"{}\" is given twice, or with its opposite", words[i]));
      set.push_back(keyword->value);
      written.move.*keyword->value = keyword->sign * number_after(words, i);
      i += 2;
    } else if (i + 1 < words.size() && (words[i + 1] == "up" || words[i + 1] == "down")) {
      if (written.height) throw InputError("the height of a second point is given twice");
      written.height = {point_named(words[i]),
                        (words[i + 1] == "up" ? 1 : -1) * number_after(words, i + 1)};
      i += 3;
    } else {
      refuse_move_word(words[i]);
    }
  }
  if (words.empty()) throw InputError("the move is empty; write it as \"forward 4 up 2\"");
  if (written.height && written.move.pitch_deg != 0)
    throw InputError("a pitch and the height of a second point exclude each other");
  check_move(written.move);
  return written;
}

ClinicalMove completed_move(const WrittenMove& written, const std::string& segment,
                            const Landmarks& landmarks, const ClinicalFrame& frame) {
  if (!written.move.about.empty() && written.move.about != "centroid" &&
      !landmarks.find(written.move.about))
    throw InputError("the case has no landmark \"" + written.move.about + "\"");
  if (!written.height) return written.move;
  const auto second = landmarks.find(written.height->landmark);
  if (!second) throw InputError("the case has no landmark \"" + written.height->landmark + "\"");
  if (point_name(written.move, segment) == "centroid")
    throw InputError("the height of a second point needs a first one: name a landmark with about");
  const Eigen::Vector3d point = point_of(written.move, segment, landmarks, Eigen::Vector3d::Zero());
  return with_height(written.move, frame, point, *second, written.height->up_mm);
}

}  // namespace condyle
