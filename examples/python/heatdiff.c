/* The shared library in the package heatdiff. In a source archive heatdiff.h lies beside this file. */
#if defined(_WIN32)
#define HEATDIFF_API __declspec(dllexport)
#elif defined(__GNUC__) || defined(__clang__)
#define HEATDIFF_API __attribute__((visibility("default")))
#endif
#define HEATDIFF_IMPLEMENTATION
#include "heatdiff.h"
