#include "sim/case/landmark_names.h"

#include <array>
#include <cctype>
#include <map>
#include <stdexcept>
#include <vector>

namespace condyle {
namespace {

struct Known {
  const char* name;
  std::vector<const char*> aliases;  // without case, spaces and separators; ' marks soft tissue
};

/// Points of the midline.
const std::vector<Known>& middle_points() {
  static const std::vector<Known> points = {
      {"upper_incisal_point",
       {"upperincisor", "upperincisaledge", "upperincisoredge", "upperincisortip", "incisorupper",
        "maxillaryincisor", "u1", "u1edge", "u1tip", "incisionsuperius", "is"}},
      {"lower_incisal_point",
       {"lowerincisor", "lowerincisaledge", "lowerincisoredge", "lowerincisortip", "incisorlower",
        "mandibularincisor", "l1", "l1edge", "l1tip", "incisioninferius", "ii"}},
      {"stomion", {"sto"}},
      {"pronasale", {"prn", "nosetip", "tipofnose"}},
      {"subnasale", {"sn"}},
      {"labrale_superius", {"ls", "upperlip"}},
      {"labrale_inferius", {"li", "lowerlip"}},
      {"soft_pogonion", {"pog'", "pg'", "pogonion'", "softtissuepogonion", "pogonionsoft"}},
      {"soft_menton", {"me'", "menton'", "softtissuementon"}},
      {"soft_gnathion", {"gn'", "gnathion'", "softtissuegnathion"}},
      {"soft_nasion", {"n'", "na'", "nasion'", "softtissuenasion"}},
      {"soft_glabella", {"g'", "gl'", "glabella'", "softtissueglabella"}},
      {"soft_b_point", {"b'", "bpoint'", "softtissueb"}},
      {"sellion", {"se"}},
      {"pogonion", {"pog", "pg"}},
      {"menton", {"me"}},
      {"gnathion", {"gn"}},
      {"nasion", {"n", "na"}},
      {"glabella", {"g", "gl"}},
      {"sella", {"s"}},
      {"basion", {"ba"}},
      {"a_point", {"a", "pointa", "subspinale"}},
      {"b_point", {"b", "pointb", "supramentale"}},
      {"ans", {"anteriornasalspine"}},
      {"pns", {"posteriornasalspine"}},
  };
  return points;
}

/// Paired points: each name and alias has a side before or after it.
const std::vector<Known>& paired_points() {
  static const std::vector<Known> points = {
      {"condyle", {"tmj", "condylecenter", "condylecentre"}},
      {"cheilion", {"ch", "chl", "mouthcorner"}},
      {"porion", {"po"}},
      {"orbitale", {"or"}},
      {"gonion", {"go"}},
      {"condylion", {"co"}},
      {"tragion", {"tr", "tragus"}},
      {"exocanthion", {"ex"}},
      {"endocanthion", {"en"}},
      {"alare", {"al"}},
      {"zygion", {"zy"}},
      {"zygomaxillare", {"zm"}},
      {"infraorbital_foramen", {"iof", "forameninfraorbitale"}},
      {"mental_foramen", {"mf", "foramenmentale"}},
      {"lingula", {"ling", "lingulamandibulae", "spineofspix"}},
      {"sigmoid_notch", {"mandibularnotch"}},
      {"coronoid_tip", {}},
  };
  return points;
}

/// Teeth of a quadrant, from the midline back.
struct ToothPlace {
  const char *name, *tip, *apex;
};
constexpr std::array<ToothPlace, 8> tooth_places = {
    {{"central_incisor", "tip", "apex"},
     {"lateral_incisor", "tip", "apex"},
     {"canine", "tip", "apex"},
     {"first_premolar", "buccal_cusp", "apex"},
     {"second_premolar", "buccal_cusp", "apex"},
     {"first_molar", "mesiobuccal_cusp", "mesiobuccal_apex"},
     {"second_molar", "mesiobuccal_cusp", "mesiobuccal_apex"},
     {"third_molar", "mesiobuccal_cusp", "mesiobuccal_apex"}}};

/// Letters and digits in lower case, and ' for soft tissue: the key for comparing aliases.
std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '\'') key += static_cast<char>(std::tolower(u));
  }
  return key;
}

/// Aliases of the points of each tooth, with the tooth written as "U3 L" or "L U3", "UL3" (Palmer),
/// or 23 (FDI). The tooth alone, unless it is an FDI number, is its tip.
void add_tooth_aliases(std::map<std::string, std::string>& names) {
  for (const int quadrant : {1, 2, 3, 4})
    for (int place = 1; place <= 8; ++place) {
      const auto canonical = tooth_landmark_names(10 * quadrant + place);
      const std::string jaw = quadrant <= 2 ? "u" : "l";
      const std::string side = quadrant == 1 || quadrant == 4 ? "r" : "l";
      const std::string number = std::to_string(place), fdi = std::to_string(quadrant) + number;
      for (const auto& point : {canonical.tip, canonical.apex}) {
        const bool is_tip = point == canonical.tip;
        names.try_emplace(key_of(point), point);
        std::vector<std::string> marks = {is_tip ? "tip" : "apex"};
        if (place <= 2 && is_tip) marks.push_back("edge");
        if (place >= 3 && is_tip) marks.push_back("cusp");
        if ((place == 4 || place == 5) && is_tip) marks.push_back("buccalcusp");
        if (place >= 6)
          for (const std::string at : {"mb", "mesiobuccal"})
            marks.push_back(at + (is_tip ? "cusp" : "apex"));
        for (const auto& mark : marks) {
          for (const auto& tooth :
               {jaw + number + side, side + jaw + number, jaw + side + number, fdi})
            names.try_emplace(tooth + mark, point);
          names.try_emplace(jaw + number + mark + side, point);
        }
        if (is_tip)
          for (const auto& tooth : {jaw + number + side, side + jaw + number, jaw + side + number})
            names.try_emplace(tooth, point);
      }
    }
}

const std::map<std::string, std::string>& aliases() {
  static const auto table = [] {
    std::map<std::string, std::string> names;
    for (const auto& known : middle_points()) {
      names[key_of(known.name)] = known.name;
      for (const char* alias : known.aliases) names[alias] = known.name;
    }
    for (const auto& known : paired_points()) {
      std::vector<std::string> forms = {key_of(known.name)};
      forms.insert(forms.end(), known.aliases.begin(), known.aliases.end());
      for (const std::string side : {"left", "right"}) {
        const std::string canonical = side + "_" + known.name;
        const std::string letter = side.substr(0, 1);
        for (const auto& form : forms) {
          for (const auto& mark : {side, letter}) {
            // A short form never hides a point of the midline ("tr", "chl" alone).
            names.try_emplace(mark + form, canonical);
            names.try_emplace(form + mark, canonical);
          }
        }
      }
    }
    add_tooth_aliases(names);
    return names;
  }();
  return table;
}

std::string snake_case(std::string_view name) {
  std::string result;
  char before = ' ';
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u)) {
      const auto b = static_cast<unsigned char>(before);
      const bool hump = std::isupper(u) && std::islower(b);
      if (!result.empty() && (hump || !std::isalnum(b)) && result.back() != '_') result += '_';
      result += static_cast<char>(std::tolower(u));
    }
    before = c;
  }
  return result;
}

}  // namespace

std::string canonical_landmark(std::string_view name) {
  const auto found = aliases().find(key_of(name));
  return found != aliases().end() ? found->second : snake_case(name);
}

ToothLandmarkNames tooth_landmark_names(int fdi) {
  const int quadrant = fdi / 10, place = fdi % 10;
  if (quadrant < 1 || quadrant > 4 || place < 1 || place > 8)
    throw std::out_of_range("no permanent tooth has this number: " + std::to_string(fdi));
  const auto& known = tooth_places[static_cast<std::size_t>(place - 1)];
  const std::string tooth = std::string(quadrant <= 2 ? "upper_" : "lower_") +
                            (quadrant == 1 || quadrant == 4 ? "right_" : "left_") + known.name;
  return {tooth + "_" + known.tip, tooth + "_" + known.apex};
}

std::vector<std::string> landmark_names() {
  std::vector<std::string> names;
  for (const auto& known : middle_points()) names.emplace_back(known.name);
  for (const auto& known : paired_points())
    for (const std::string side : {"left_", "right_"}) names.push_back(side + known.name);
  for (const int quadrant : {1, 2, 3, 4})
    for (int place = 1; place <= 8; ++place) {
      const auto tooth = tooth_landmark_names(10 * quadrant + place);
      names.insert(names.end(), {tooth.tip, tooth.apex});
    }
  return names;
}

}  // namespace condyle
