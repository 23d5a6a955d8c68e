// A plug-in for another Raymeter: if its function were called, it would end the program with status 99.
#include <cstdlib>

extern "C" {
extern const char raymeter_plugin_abi[64];
const char raymeter_plugin_abi[64] = "Raymeter 0.0.1, interface 0";
void raymeter_plugin_register(void* /*registry*/) {
  std::_Exit(99);
}
}
