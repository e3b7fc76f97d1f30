#include "engine/dicom/shown_facts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <regex>
#include <utility>

namespace condyle {
namespace {

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

template <std::size_t size>
bool is_among(const std::array<std::string_view, size>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// GE and Philips name their kernels by words.
constexpr std::array<std::string_view, 39> kernel_words = {
    "STANDARD", "STD+",  "BONE+", "SOFT",    "DETAIL",     "BONE",   "BONEPLUS",   "LUNG",
    "EDGE",     "ULTRA", "CHST",  "HD BONE", "PARENCHYMA", "SMOOTH", "SHARP",      "A",
    "B",        "C",     "D",     "E",       "F",          "L",      "UA",         "UB",
    "UC",       "YA",    "YB",    "YC",      "YD",         "EA",     "EB",         "EC",
    "ED",       "IMR",   "BRAIN", "HEAD",    "RAMP",       "HANN",   "SHEPP-LOGAN"};

}  // namespace

std::string shown_modality(std::string_view text) {
  constexpr std::array<std::string_view, 23> known = {
      "CT", "MR", "PT", "NM", "US", "CR",  "DX",  "MG",       "XA",     "RF",      "OT", "SC",
      "SR", "PR", "KO", "IO", "PX", "SEG", "REG", "RTSTRUCT", "RTDOSE", "RTIMAGE", "ES"};
  return is_among(known, text) ? std::string(text) : "other";
}

std::string shown_kernel(std::string_view text) {
  if (text.empty()) return "";
  // Siemens B30f, H60s, Br40d, Hr69h; Canon FC08, FL03; Philips IMR1.
  static const std::regex forms(
      "[BHTUJIQSA][a-z]?\\d{2}[a-z]?|F[CL]\\d\\d[A-Z]?|IMR\\d|YA\\d|R\\d\\d");
  const std::string first(
      text.substr(0, text.find('\\')));  // Siemens adds a strength as second value
  if (std::regex_match(first, forms)) return first;
  return is_among(kernel_words, upper_case(first)) ? first : "other";
}

std::string shown_manufacturer(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, const char*>, 26> known = {
      {{"SIEMENS", "Siemens"},       {"GE MEDICAL", "GE"},
       {"GE HEALTHCARE", "GE"},      {"PHILIPS", "Philips"},
       {"MARCONI", "Marconi"},       {"PICKER", "Picker"},
       {"ELSCINT", "Elscint"},       {"TOSHIBA", "Toshiba"},
       {"CANON", "Canon"},           {"HITACHI", "Hitachi"},
       {"FUJIFILM", "Fujifilm"},     {"NEUSOFT", "Neusoft"},
       {"UIH", "United Imaging"},    {"PLANMECA", "Planmeca"},
       {"CARESTREAM", "Carestream"}, {"KAVO", "KaVo"},
       {"NEWTOM", "NewTom"},         {"QR SRL", "NewTom"},
       {"VATECH", "Vatech"},         {"MORITA", "Morita"},
       {"SIRONA", "Sirona"},         {"IMAGING SCIENCES", "Imaging Sciences"},
       {"ACTEON", "Acteon"},         {"INSTRUMENTARIUM", "Instrumentarium"},
       {"CONDYLE", "Condyle"},       {"SAMSUNG", "Samsung"}}};
  const std::string upper = upper_case(text);
  const auto found = std::find_if(known.begin(), known.end(), [&](const auto& each) {
    return upper.find(each.first) != std::string::npos;
  });
  return found == known.end() ? "" : found->second;
}

}  // namespace condyle
