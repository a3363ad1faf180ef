# What `cmake --install` leaves behind, so that another project can say
#
#   find_package(nephroid REQUIRED COMPONENTS pipeline)
#   target_link_libraries(mine PRIVATE nephroid::pipeline)
#   nephroid_add_kernels(mine mine.kernels.cpp)
#
# One export per component: a project that asks for the pipeline alone needs no picture library to be there.
option(NEPHROID_INSTALL "Install the libraries, and the program where it is built" ${PROJECT_IS_TOP_LEVEL})
if(NOT NEPHROID_INSTALL)
  return()
endif()
include(CMakePackageConfigHelpers)

set(NEPHROID_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/nephroid)
set(NEPHROID_HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/nephroid)

function(_nephroid_install_component component)
  install(TARGETS ${ARGN} EXPORT nephroid_${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT nephroid_${component} NAMESPACE nephroid:: FILE nephroid_${component}.cmake DESTINATION ${NEPHROID_PACKAGE_DIR})
endfunction()

_nephroid_install_component(pipeline nephroid_pipeline)
_nephroid_install_component(stages nephroid_stages)
_nephroid_install_component(scene_data nephroid_scene_data)
if(NEPHROID_SCENES)
  _nephroid_install_component(scenes nephroid_scenes)
endif()
if(TARGET nephroid_world)
  set_target_properties(nephroid_world PROPERTIES EXPORT_NAME world)
  _nephroid_install_component(world nephroid_world)
  install(FILES tools/world_builder.hpp DESTINATION ${NEPHROID_HEADER_DIR}/tools)
endif()

# The parts' headers, but for those that only their own sources use.
install(DIRECTORY pipeline DESTINATION ${NEPHROID_HEADER_DIR} FILES_MATCHING PATTERN "*.hpp"
  PATTERN "draw_context.hpp" EXCLUDE PATTERN "validation.hpp" EXCLUDE PATTERN "stream_output.hpp" EXCLUDE PATTERN "mip_kernels.hpp" EXCLUDE
  PATTERN "primitive_set_up.hpp" EXCLUDE PATTERN "edges.hpp" EXCLUDE PATTERN "weight_planes.hpp" EXCLUDE
  PATTERN "rasterizer.hpp" EXCLUDE PATTERN "output_merger.hpp" EXCLUDE)
install(DIRECTORY stages DESTINATION ${NEPHROID_HEADER_DIR} FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY scenes DESTINATION ${NEPHROID_HEADER_DIR} FILES_MATCHING PATTERN "*.hpp"
  PATTERN "pictures" EXCLUDE PATTERN "gltf_*.hpp" EXCLUDE PATTERN "tinygltf.hpp" EXCLUDE PATTERN "medium_json.hpp" EXCLUDE)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/nephroidConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/nephroidConfig.cmake INSTALL_DESTINATION ${NEPHROID_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/nephroidConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nephroidConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/nephroidConfigVersion.cmake cmake/NephroidKernels.cmake
  DESTINATION ${NEPHROID_PACKAGE_DIR})

if(NEPHROID_TESTS)
  add_test(NAME install COMMAND ${PROJECT_SOURCE_DIR}/tests/install/run ${CMAKE_BINARY_DIR})
endif()
