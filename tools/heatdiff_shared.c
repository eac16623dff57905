/* The shared library heatdiff (CMake: -DHEATDIFF_BUILD_SHARED=ON). Programs include heatdiff.h without HEATDIFF_IMPLEMENTATION. */
#if defined(_WIN32)
#define HEATDIFF_API __declspec(dllexport)
#elif defined(__GNUC__) || defined(__clang__)
#define HEATDIFF_API __attribute__((visibility("default")))
#endif
#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
