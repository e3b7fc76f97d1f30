#include "sim/anatomy_fit/definitions.h"

namespace condyle {

void apply_definitions(std::map<std::string, ProposedLandmark>& marks, const FittedPart& part,
                       const Case& model) {
  (void)marks;
  (void)part;
  (void)model;
}

}  // namespace condyle
