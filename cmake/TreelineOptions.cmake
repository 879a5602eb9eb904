# treeline_options: how our own programs and libraries are compiled. Never exported, never global.
add_library(treeline_options INTERFACE)
target_compile_features(treeline_options INTERFACE cxx_std_20)
# -fno-math-errno and -fno-trapping-math let GCC vectorise numeric loops without touching NaN or rounding.
target_compile_options(treeline_options INTERFACE -Wall -Wextra -fno-math-errno -fno-trapping-math)
set(TREELINE_ISA_FLAGS "")
if(TREELINE_ISA STREQUAL "native")
  set(TREELINE_ISA_FLAGS -march=native)
elseif(NOT TREELINE_ISA STREQUAL "baseline")
  message(FATAL_ERROR "TREELINE_ISA is '${TREELINE_ISA}'; it must be native or baseline")
endif()
target_compile_options(treeline_options INTERFACE ${TREELINE_ISA_FLAGS})

# treeline_sanitize: also for what links libraries built with other -m flags.
add_library(treeline_sanitize INTERFACE)
if(TREELINE_SANITIZE)
  target_compile_options(treeline_sanitize INTERFACE -fsanitize=${TREELINE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(treeline_sanitize INTERFACE -fsanitize=${TREELINE_SANITIZE})
  target_compile_definitions(treeline_sanitize INTERFACE TREELINE_SANITIZED=1)
endif()
if(TREELINE_FUZZ)
  target_compile_options(treeline_sanitize INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
endif()
target_link_libraries(treeline_options INTERFACE treeline_sanitize)

find_program(TREELINE_CCACHE ccache)
if(TREELINE_CCACHE AND PROJECT_IS_TOP_LEVEL)
  # Ninja asks for the headers of each file anyway: ccache need not preprocess it to know them.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1 ${TREELINE_CCACHE})
endif()

# Most of what a small source costs is its headers. With TREELINE_UNITY off each source is compiled by itself: for
# clangd, and for whoever edits one of them again and again.
option(TREELINE_UNITY "Compile the small sources of a target together" ON)
function(treeline_together target batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TREELINE_UNITY} UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()
