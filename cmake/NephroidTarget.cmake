# What all targets of this project share.

# Masks are combined with & and |, and a mask of one lane is a bool: Clang would rather have && there.
set(NEPHROID_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-psabi
  $<$<CXX_COMPILER_ID:Clang>:-Wno-bitwise-instead-of-logical>)

function(nephroid_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${NEPHROID_WARNINGS} $<$<BOOL:${NEPHROID_WERROR}>:-Werror>)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
endfunction()

# For targets whose files take longer to read their headers (CLI11, nlohmann's json, OpenImageIO, doctest) than for the rest.
option(NEPHROID_JOIN_SOURCES "Compile tools, scenes and tests several files at a time: quicker from nothing, slower after a change" OFF)
function(nephroid_join_sources target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${NEPHROID_JOIN_SOURCES} UNITY_BUILD_BATCH_SIZE 6)
endfunction()
