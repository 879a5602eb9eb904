# Installs the tree into an empty prefix, copies the consumer project beside it, and configures, builds and runs
# it with no peer visible: find_package is disabled for each of them, and the compiler is shown no file of theirs.
# Usage: cmake -DBUILD=… -DSOURCE=… -DWORK=… -DGENERATOR=… -DCXX=… -P check.cmake
foreach(name BUILD SOURCE WORK GENERATOR CXX)
  if(NOT DEFINED ${name})
    message(FATAL_ERROR "check.cmake needs -D${name}=…")
  endif()
endforeach()

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    string(REPLACE ";" " " command "${ARGV}")
    message(FATAL_ERROR "${command}\nended with ${status}:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)

# The consumer lies outside the source tree, so that nothing is found by accident.
file(COPY ${SOURCE}/project DESTINATION ${WORK})
set(peers CGAL embree OpenMesh PCL FLANN flann nanoflann benchmark OpenImageIO OpenCV OpenVDB Eigen3 Boost assimp GTest
    rapidcheck CLI11 fmt nlohmann_json)
set(disabled "")
foreach(peer ${peers})
  list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${peer}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${WORK}/project -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_EXPORT_COMPILE_COMMANDS=ON ${disabled})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)

# Disabling find_package does not hide headers in /usr/include, so ask the compiler what it read.
execute_process(COMMAND ${CXX} -std=c++20 -M -I ${WORK}/prefix/include/treeline ${WORK}/project/main.cpp
                RESULT_VARIABLE status OUTPUT_VARIABLE read ERROR_VARIABLE error)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${CXX} -M failed:\n${error}")
endif()
if(NOT read MATCHES "prefix/include/treeline/accel/kd_tree")
  message(FATAL_ERROR "the consumer did not read the installed headers:\n${read}")
endif()
string(TOLOWER "${read}" read)
foreach(peer cgal embree openmesh /pcl flann benchmark openimageio opencv openvdb eigen /boost assimp gtest rapidcheck
        /cli/ /fmt/ nlohmann)
  if(read MATCHES "(/usr[^ ]*${peer}[^ ]*)")
    message(FATAL_ERROR "the installed headers read a file of a peer: ${CMAKE_MATCH_1}")
  endif()
endforeach()
file(READ ${WORK}/build/compile_commands.json commands)
if(commands MATCHES "-march|-mavx|-ffast-math|-fno-")
  message(FATAL_ERROR "the installed targets impose flags on their users:\n${commands}")
endif()
