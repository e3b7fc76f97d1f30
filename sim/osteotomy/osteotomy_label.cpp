#include "sim/osteotomy/osteotomy_label.h"

#include <map>

#include "sim/frame/part_names.h"

namespace condyle {

std::string osteotomy_label(const std::string& name) {
  static const std::map<std::string, std::string> labels = {{"le_fort_1", "Le Fort I"},
                                                            {"le_fort_2", "Le Fort II"},
                                                            {"le_fort_3", "Le Fort III"},
                                                            {"inverted_l", "Inverted L"}};
  const auto known = labels.find(name);
  return known == labels.end() ? display_name(name) : known->second;
}

}  // namespace condyle
