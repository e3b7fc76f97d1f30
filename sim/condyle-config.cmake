# Package of the simulator without renderer and program. Target condyle::sim; its headers are
# included as in the source tree, e.g. "sim/simulator/simulator.h".
include(CMakeFindDependencyMacro)
find_dependency(PkgConfig)
find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(fcl 0.7)
find_dependency(meshoptimizer)
find_dependency(TBB)
find_dependency(nlohmann_json)
find_dependency(TinyGLTF)
find_dependency(fmt)
pkg_check_modules(bullet REQUIRED IMPORTED_TARGET bullet-float64)
include("${CMAKE_CURRENT_LIST_DIR}/condyle-targets.cmake")
