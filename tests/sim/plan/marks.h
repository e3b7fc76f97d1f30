#pragma once

#include "sim/case/landmarks.h"

namespace condyle::test {

/// A symmetric head with its Frankfort plane at z = 0.
inline Landmarks upright_marks() {
  return {{{"nasion", {0, -90, 26}},
           {"sella", {0, -20, 17}},
           {"basion", {0, 0, -27}},
           {"left_porion", {62, 0, 0}},
           {"right_porion", {-62, 0, 0}},
           {"left_orbitale", {32, -79, 0}},
           {"right_orbitale", {-32, -79, 0}},
           {"upper_incisal_point", {0, -95, -53}},
           {"pns", {0, -44, -27}},
           {"pogonion", {0, -91, -82}}}};
}

}  // namespace condyle::test
