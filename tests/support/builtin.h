#pragma once

#include "sim/phantom/phantom.h"

namespace condyle::test {

/// The built-in patient, made once a program.
inline const Case& builtin() {
  static const Case patient = builtin_patient();
  return patient;
}

}  // namespace condyle::test
