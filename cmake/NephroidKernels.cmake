# Kernels are compiled once per instruction set.
#
#   nephroid_add_kernels(TARGET FILE...)
#
# compiles each FILE for plain floats and for every instruction set in NEPHROID_ISAS_BUILT and links all of it into TARGET.
# A FILE instantiates kernels for the instruction set it is being compiled for:
#
#   #include <pipeline/kernels.hpp>
#   template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, MyVertexShader, NoGeometryShader, MyPixelShader>;
#
# What is compiled for AVX-512 must never be called on a processor without it. Templates and inline functions shared with
# the rest of the program (glm::vec<3, float>'s operators, std::max<float>) have one name whatever they were compiled for,
# and a linker keeps whichever copy it meets first. So each instruction set's objects are linked into one, and every
# symbol in it but the kernels' own is made local.

if(NEPHROID_ISAS STREQUAL "auto")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set(NEPHROID_ISAS_BUILT sse42 avx2 avx512)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
    set(NEPHROID_ISAS_BUILT neon)
  else()
    set(NEPHROID_ISAS_BUILT)
  endif()
elseif(NEPHROID_ISAS STREQUAL "none")
  set(NEPHROID_ISAS_BUILT)
else()
  set(NEPHROID_ISAS_BUILT ${NEPHROID_ISAS})
endif()

# The function below may be called from a folder that does not see this one's variables: what it reads is global.
set_property(GLOBAL PROPERTY NEPHROID_ISAS_BUILT ${NEPHROID_ISAS_BUILT})
set_property(GLOBAL PROPERTY NEPHROID_ISOLATE_KERNELS ${NEPHROID_ISOLATE_KERNELS})
macro(_nephroid_isa_settings)
  set(NEPHROID_ISA_NAME_scalar Scalar)
  set(NEPHROID_ISA_NAME_sse42 Sse42)
  set(NEPHROID_ISA_NAME_avx2 Avx2)
  set(NEPHROID_ISA_NAME_avx512 Avx512)
  set(NEPHROID_ISA_NAME_neon Neon)
  set(NEPHROID_ISA_FLAGS_sse42 -msse4.2)
  set(NEPHROID_ISA_FLAGS_avx2 -mavx2 -mf16c -mtune=haswell)
  set(NEPHROID_ISA_FLAGS_avx512 -mavx512f -mavx512bw -mavx512dq -mavx512vl -mf16c -mtune=skylake-avx512)
  # Structs of lanes are copied a whole register at a time: what is stored in halves cannot be loaded whole without a wait.
  # GCC 12 takes the deliberately undefined operand inside its own AVX-512 intrinsics for a mistake of ours.
  set(NEPHROID_ISA_FLAGS_GNU_avx2 -mmove-max=256 -mstore-max=256)
  set(NEPHROID_ISA_FLAGS_GNU_avx512 -mprefer-vector-width=512 -mmove-max=512 -mstore-max=512 -Wno-uninitialized -Wno-maybe-uninitialized)
  set(NEPHROID_ISA_FLAGS_Clang_avx512 -mprefer-vector-width=512)
endmacro()

# A target with the kernels' compile flags and its own usage requirements, for one instruction set.
function(_nephroid_kernel_objects target isa out)
  set(objects ${target}_${isa})
  add_library(${objects} OBJECT ${ARGN})
  target_compile_features(${objects} PRIVATE cxx_std_20)
  target_compile_definitions(${objects} PRIVATE NEPHROID_KERNEL_ISA=Isa::${NEPHROID_ISA_NAME_${isa}}
    $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
  target_include_directories(${objects} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
  # GCC marks inline variables, which an unoptimised build keeps, as unique in the whole program: those cannot be made local.
  target_compile_options(${objects} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_OPTIONS> ${NEPHROID_ISA_FLAGS_${isa}}
    "$<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique;${NEPHROID_ISA_FLAGS_GNU_${isa}}>" "$<$<CXX_COMPILER_ID:Clang>:${NEPHROID_ISA_FLAGS_Clang_${isa}}>")
  target_link_libraries(${objects} PRIVATE $<TARGET_PROPERTY:${target},LINK_LIBRARIES>)
  set_target_properties(${objects} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  set(${out} ${objects} PARENT_SCOPE)
endfunction()

function(nephroid_add_kernels target)
  _nephroid_isa_settings()
  get_property(isas GLOBAL PROPERTY NEPHROID_ISAS_BUILT)
  get_property(isolate GLOBAL PROPERTY NEPHROID_ISOLATE_KERNELS)
  list(TRANSFORM ARGN REPLACE "^([^/].*)$" "${CMAKE_CURRENT_SOURCE_DIR}/\\1" OUTPUT_VARIABLE files)
  foreach(isa IN ITEMS scalar LISTS isas)
    _nephroid_kernel_objects(${target} ${isa} objects ${files})
    if(isolate AND NEPHROID_ISA_FLAGS_${isa})
      # Where lld is installed CMake prefers it for Clang, but it does not take groups apart.
      set(linker ${CMAKE_LINKER})
      if(linker MATCHES "lld")
        find_program(NEPHROID_GNU_LD ld.bfd REQUIRED)
        set(linker ${NEPHROID_GNU_LD})
      endif()
      set(isolated ${CMAKE_CURRENT_BINARY_DIR}/${target}_${isa}_kernels.o)
      add_custom_command(
        OUTPUT ${isolated}
        COMMAND ${linker} -r --force-group-allocation -o ${isolated} $<TARGET_OBJECTS:${objects}>
        COMMAND ${CMAKE_OBJCOPY} --wildcard "--keep-global-symbol=_ZN8nephroid*Kernels*5tableEv" ${isolated}
        DEPENDS $<TARGET_OBJECTS:${objects}>
        COMMAND_EXPAND_LISTS VERBATIM COMMENT "Isolating ${isa} kernels of ${target}")
      set_source_files_properties(${isolated} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
      target_sources(${target} PRIVATE ${isolated})
    else()
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
    endif()
  endforeach()
endfunction()
