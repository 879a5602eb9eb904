# Types that cannot be: each must be refused with a message in plain words, and its right neighbour compile.
# Usage: cmake -DSOURCE=… -DWORK=… -DCXX=… -P refused_types.cmake
file(MAKE_DIRECTORY ${WORK})
# GCC reads these precompiled, a compiler that does not look for that as they are.
file(WRITE ${WORK}/trees.hpp "#include <accel/bsp_tree.hpp>
#include <accel/brute_force.hpp>
#include <accel/bvh.hpp>
#include <accel/kd_tree.hpp>
")
execute_process(COMMAND ${CXX} -std=c++20 -I${SOURCE} -x c++-header ${WORK}/trees.hpp -o ${WORK}/trees.hpp.gch)
function(expect type message)
  file(WRITE ${WORK}/type.cpp "#include \"trees.hpp\"
using namespace treeline;
using namespace treeline::accel;
auto size = sizeof(${type});
")
  execute_process(COMMAND ${CXX} -std=c++20 -fsyntax-only -I${SOURCE} ${WORK}/type.cpp RESULT_VARIABLE status
                  ERROR_VARIABLE error)
  if(message STREQUAL "")
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "${type} does not compile:\n${error}")
    endif()
  elseif(status EQUAL 0)
    message(FATAL_ERROR "${type} is not refused")
  elseif(NOT error MATCHES "${message}")
    message(FATAL_ERROR "${type} is refused without '${message}':\n${error}")
  endif()
endfunction()

expect("Bvh<Triangles<float, geometry::Exact>, Wide>" "")
expect("Bvh<Triangles<float>, WideCompact<8>>" "")
foreach(tree Bvh KdTree BspTree BruteForce)
  expect("${tree}<Triangles<float, geometry::Exact>>" "rays decided.*exactly: accel::Bvh<")
endforeach()
expect("Bvh<Triangles<double>, Wide>" "for doubles there is the binary layout")
expect("Bvh<Triangles<double, geometry::Exact>, WideCompact<>>" "for doubles there is the binary layout")
expect("Bvh<Triangles<float, geometry::MollerTrumbore>, Wide>" "wide trees over triangles take the ray tests")
