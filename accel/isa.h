#pragma once
// Which of the instruction sets, for which kernels were compiled, a structure uses.
#include <string>
#include <vector>

#include "scenes/base/error.h"
#include "scenes/base/spec.h"

namespace raymeter {

/// The parameter `isa`.
inline Parameter isa_parameter() {
  return {.name = "isa",
          .type = ParameterType::choice,
          .default_value = "default",
          .meaning = "instruction set; default: the widest that the CPU has",
          .choices = {"default", "sse4.2", "avx2", "avx512"}};
}

/// Of `kernels`, those that this CPU can run, the ones that `isa` names. Throws Error naming the structure.
template <class Kernels>
const Kernels& kernels_for(const Arguments& arguments, const std::vector<const Kernels*>& kernels) {
  if (kernels.empty()) throw Error(arguments.name() + " needs an x86 CPU with SSE4.2");
  const std::string& isa = arguments.text("isa");
  if (isa == "default") return *kernels.front();
  for (const Kernels* const k : kernels)
    if (k->isa == isa) return *k;
  throw Error(arguments.name() + ": this CPU has no " + isa);
}

}  // namespace raymeter
