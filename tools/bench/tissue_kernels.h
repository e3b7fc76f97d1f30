#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace condyle {

/// Rows factor.condyle, factor.cholmod and factor.eigen: the Cholesky factor of one tissue's
/// Hessian by each; empty where condyle-factors is not built beside the program.
nlohmann::ordered_json factor_rows();

/// Rows elements.condyle and elements.plain: energy and gradient of the springs and prisms of
/// tissues of about these numbers of nodes, on one thread.
nlohmann::ordered_json element_rows(const std::vector<int>& sizes);

/// Both as a table.
void print_kernel_rows(const nlohmann::ordered_json& rows);

/// What a program beside this one prints on standard output, as JSON; null where it is not built.
/// throws: MachineError when it fails.
nlohmann::ordered_json output_of_companion(const char* program, const char* arguments);

}  // namespace condyle
