#include "sim/case/case.h"

#include <utility>

namespace condyle {

BodyId Case::add_piece(Part part, BodyId parent, BodyDriver driver) {
  part.body = bodies.add({.name = part.name, .parent = parent, .driver = driver});
  parts.push_back(std::move(part));
  return parts.back().body;
}

}  // namespace condyle
