// Prints the least clearance of a case at rest.   outside CASE_FOLDER
#include <cstdio>

#include "sim/case/case_io.h"
#include "sim/simulator/simulator.h"

int main(int count, char** arguments) {
  if (count != 2) return 2;
  condyle::SimulatorSettings settings;
  settings.tissue = false;
  settings.threads = 1;
  const condyle::Scene scene = condyle::make_scene(condyle::load_case(arguments[1]), settings);
  std::printf("clearance %.3f mm\n", condyle::rest_frame(scene).contacts.min_clearance_mm());
}
