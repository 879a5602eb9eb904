# How a benchmark task is put together from small object libraries, one a method, so that static registration
# survives the linker and each peer keeps its own flags.
#
#   treeline_bench_task(knn SOURCES task.cpp truth.cpp [MAIN main.cpp] [LINK library...])
#     bench_knn (in <build>/bench), and treeline_bench_knn: everything but main, for tests to link.
#     The task's SOURCES see TREELINE_TASK_METHODS ("bvh,flann") and TREELINE_TASK_NOT_BUILT ("pcl:PCL").
#   treeline_bench_method(knn flann [SOURCES flann.cpp] [METHODS flann flann_forest] [PACKAGE FLANN]
#                         [TARGETS flann::flann_cpp] [LINK library...] [PLAIN])
#     One file (default <name>.cpp) that registers METHODS (default: its name). If any of TARGETS does not
#     exist, the methods are noted as not built for want of PACKAGE. PLAIN: without our -m flags, for
#     libraries whose ABI depends on them.
#   treeline_bench_part(knn oracle SOURCES oracle.cpp [PACKAGE CGAL] [TARGETS CGAL::CGAL] [LINK ...] [PLAIN])
#     Other code with flags of its own. Where it is left out, the task's sources see TREELINE_WITHOUT_ORACLE=1.
# Call find_package before; set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON) is in force below bench/.

# Adds object library treeline_bench_<task>_<name>, or sets <absent> to the missing target.
function(_treeline_bench_objects task name absent)
  cmake_parse_arguments(PARSE_ARGV 3 B "PLAIN" "PACKAGE" "SOURCES;METHODS;TARGETS;LINK")
  foreach(target IN LISTS B_TARGETS)
    if(NOT TARGET ${target})
      set(${absent} ${target} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${absent} "" PARENT_SCOPE)
  if(NOT B_SOURCES)
    set(B_SOURCES ${name}.cpp)
  endif()
  set(objects treeline_bench_${task}_${name})
  add_library(${objects} OBJECT ${B_SOURCES})
  target_link_libraries(${objects} PRIVATE treeline_bench_interface ${B_TARGETS} ${B_LINK})
  if(B_PLAIN)
    target_link_libraries(${objects} PRIVATE treeline_sanitize)
  else()
    target_link_libraries(${objects} PRIVATE treeline_options)
    if("CGAL::CGAL" IN_LIST B_TARGETS)
      treeline_precompiled(${objects} bench_cgal)
    elseif(NOT name STREQUAL "task")  # which is not hot
      treeline_precompiled(${objects} bench)
    endif()
  endif()
  target_sources(treeline_bench_${task} INTERFACE $<TARGET_OBJECTS:${objects}>)
  foreach(library IN LISTS B_TARGETS B_LINK)
    target_link_libraries(treeline_bench_${task} INTERFACE $<LINK_ONLY:${library}>)
  endforeach()
endfunction()

# A target where no time is spent when it runs.
function(treeline_bench_not_hot target)
  target_compile_options(${target} PRIVATE ${TREELINE_NOT_HOT})
  treeline_together(${target} 8)
  treeline_precompiled(${target} bench_not_hot)
endfunction()

function(treeline_bench_task task)
  cmake_parse_arguments(PARSE_ARGV 1 B "" "" "MAIN;SOURCES;LINK")
  if(NOT B_MAIN)
    set(B_MAIN main.cpp)
  endif()
  set(not_hot ${B_SOURCES})
  list(FILTER not_hot INCLUDE REGEX "^(../ray/)?(task|figures|[a-z_]*pictures?|png[a-z_]*|slice_svg)[.]cpp$")
  set(hot ${B_SOURCES})
  list(REMOVE_ITEM hot ${not_hot})
  add_library(treeline_bench_${task} INTERFACE)
  target_link_libraries(treeline_bench_${task} INTERFACE treeline_bench_core ${B_LINK})
  _treeline_bench_objects(${task} task absent SOURCES ${not_hot} LINK ${B_LINK})
  treeline_bench_not_hot(treeline_bench_${task}_task)
  if(hot)
    _treeline_bench_objects(${task} judging absent SOURCES ${hot} LINK ${B_LINK})
    treeline_together(treeline_bench_${task}_judging 4)
  endif()
  set(of_task TARGET_PROPERTY:treeline_bench_${task})
  foreach(part task judging)
    if(TARGET treeline_bench_${task}_${part})
      target_compile_definitions(treeline_bench_${task}_${part} PRIVATE
        "TREELINE_TASK_METHODS=\"$<JOIN:$<${of_task},TREELINE_METHODS>,$<COMMA>>\""
        "TREELINE_TASK_NOT_BUILT=\"$<JOIN:$<${of_task},TREELINE_NOT_BUILT>,$<COMMA>>\""
        "$<${of_task},TREELINE_WITHOUT>")
    endif()
  endforeach()
  add_executable(bench_${task} ${B_MAIN})
  treeline_bench_not_hot(bench_${task})
  target_link_libraries(bench_${task} PRIVATE treeline_bench_${task} treeline_options)
  set_target_properties(bench_${task} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${treeline_BINARY_DIR}/bench)
  set_property(GLOBAL APPEND PROPERTY TREELINE_BENCH_TASKS ${task})
endfunction()

function(treeline_bench_method task name)
  cmake_parse_arguments(PARSE_ARGV 2 B "PLAIN" "PACKAGE" "SOURCES;METHODS;TARGETS;LINK")
  if(NOT B_METHODS)
    set(B_METHODS ${name})
  endif()
  _treeline_bench_objects(${task} ${name} absent ${ARGN})
  if(absent)
    foreach(method IN LISTS B_METHODS)
      message(STATUS "bench_${task}: ${method} is not built, ${B_PACKAGE} (${absent}) was not found")
      set_property(TARGET treeline_bench_${task} APPEND PROPERTY TREELINE_NOT_BUILT "${method}:${B_PACKAGE}")
    endforeach()
  else()
    set_property(TARGET treeline_bench_${task} APPEND PROPERTY TREELINE_METHODS ${B_METHODS})
  endif()
endfunction()

function(treeline_bench_part task name)
  cmake_parse_arguments(PARSE_ARGV 2 B "PLAIN" "PACKAGE" "SOURCES;METHODS;TARGETS;LINK")
  _treeline_bench_objects(${task} ${name} absent ${ARGN})
  if(absent)
    message(STATUS "bench_${task}: ${name} is left out, ${B_PACKAGE} (${absent}) was not found")
    string(TOUPPER ${name} upper)
    set_property(TARGET treeline_bench_${task} APPEND PROPERTY TREELINE_WITHOUT TREELINE_WITHOUT_${upper}=1)
  endif()
endfunction()
