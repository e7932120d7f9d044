# cmake --install: libraries, headers and strataConfig.cmake with strata::core, strata::memory and
# strata::components.
