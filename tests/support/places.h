// Where the checkout and the program under test are.
#pragma once

#include <filesystem>

namespace condyle::test {

std::filesystem::path source_folder();
std::filesystem::path program_file();

}  // namespace condyle::test
