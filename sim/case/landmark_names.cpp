#include "sim/case/landmark_names.h"

#include <cctype>
#include <map>
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
  };
  return points;
}

/// Letters and digits in lower case, and ' for soft tissue: the key for comparing aliases.
std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '\'') key += static_cast<char>(std::tolower(u));
  }
  return key;
}

const std::map<std::string, std::string>& aliases() {
  static const auto table = [] {
    std::map<std::string, std::string> names;
    for (const auto& known : middle_points()) {
      names[key_of(known.name)] = known.name;
      for (const char* alias : known.aliases) names[alias] = known.name;
    }
    for (const auto& known : paired_points()) {
      std::vector<std::string> forms = {known.name};
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

std::vector<std::string> landmark_names() {
  std::vector<std::string> names;
  for (const auto& known : middle_points()) names.emplace_back(known.name);
  for (const auto& known : paired_points())
    for (const std::string side : {"left_", "right_"}) names.push_back(side + known.name);
  return names;
}

}  // namespace condyle
