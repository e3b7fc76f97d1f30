#include "tests/support/places.h"

namespace condyle::test {

std::filesystem::path source_folder() { return CONDYLE_SOURCE_DIR; }
std::filesystem::path program_file() { return CONDYLE_PROGRAM; }

}  // namespace condyle::test
