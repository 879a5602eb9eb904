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

# Where no time is spent when it runs: -O1 compiles it in two thirds of the time.
set(TREELINE_NOT_HOT "$<$<CONFIG:Release>:-O1>")

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
  # Ninja asks for the headers of each file anyway: ccache need not preprocess it to know them. The other two are what
  # it asks for to keep what was compiled with precompiled headers, which hold no dates and no macros of ours.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${TREELINE_CCACHE})
endif()

# Most of what a small source costs is its headers. With TREELINE_UNITY off each source is compiled by itself: for
# clangd, and for whoever edits one of them again and again.
option(TREELINE_UNITY "Compile the small sources of a target together" ON)
function(treeline_together target batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TREELINE_UNITY} UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()

# Of the 26 s of CPU that bench/knn/brute.cpp took, on a virtual machine where fresh memory is dear, six went into reading
# the standard library, the intrinsics, oneTBB and the JSON type. GCC takes headers compiled with other flags of
# the optimiser without a word, keeps those flags for what is in them, and may crash over it: hence a set of headers for
# each set of flags; sources with flags of their own go without (SKIP_PRECOMPILE_HEADERS).
#   treeline_precompiled_set(SET [HEADERS header...] [LINK library...] [OPTIONS flag...])
#   treeline_precompiled(TARGET SET)
set(TREELINE_PCH_DEFAULT OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # which it was tried with
  set(TREELINE_PCH_DEFAULT ON)
endif()
option(TREELINE_PCH "Read the headers that most sources share precompiled" ${TREELINE_PCH_DEFAULT})
function(treeline_precompiled_set set)
  cmake_parse_arguments(PARSE_ARGV 1 P "" "" "HEADERS;LINK;OPTIONS")
  if(TREELINE_PCH)
    add_library(treeline_pch_${set} OBJECT ${treeline_SOURCE_DIR}/cmake/precompiled.cpp)
    target_link_libraries(treeline_pch_${set} PRIVATE treeline_options ${P_LINK})
    target_compile_options(treeline_pch_${set} PRIVATE ${P_OPTIONS})
    target_precompile_headers(treeline_pch_${set} PRIVATE ${treeline_SOURCE_DIR}/cmake/precompiled.hpp ${P_HEADERS})
  endif()
endfunction()
function(treeline_precompiled target set)
  if(TARGET treeline_pch_${set})
    target_precompile_headers(${target} REUSE_FROM treeline_pch_${set})
  endif()
endfunction()
