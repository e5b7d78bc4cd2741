/* The slip law as an FMU of FMI 3.0 for co-simulation. Prototypes as the standard has them (FMI 3.0.1, chapters 2.2 and 4.2). */
#include <stdbool.h>
#include <stddef.h>

typedef void (*LogMessage)(void *, int, const char *, const char *);

typedef struct {
    void *environment;
    LogMessage log;
} Caller;

static void tell(Caller caller, int status, const char *message) {
    if (caller.log != NULL) {
        caller.log(caller.environment, status, "error", message);
    }
}

#include "instance.h"

EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool events, bool early, const unsigned *required, size_t count,
                                         void *environment, LogMessage log, void *intermediate) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early;
    (void)required, (void)count, (void)intermediate;
    return instance_new(token, "{slip-law-3}", (Caller){environment, log});
}

EXPORT void fmi3FreeInstance(void *instance) {
    free(instance);
}

EXPORT int fmi3SetFloat64(Instance *instance, const unsigned *references, size_t count, const double *values,
                          size_t length) {
    return length == count ? law_write(&instance->law, references, count, values) : ERROR;
}

EXPORT int fmi3GetFloat64(Instance *instance, const unsigned *references, size_t count, double *values, size_t length) {
    return length == count ? law_read(&instance->law, references, count, values) : ERROR;
}

EXPORT int fmi3DoStep(Instance *instance, double t, double step, bool final, bool *event, bool *terminate, bool *early,
                      double *last) {
    (void)final;
    *event = *terminate = *early = false;
    *last = t + step;
    Law *law = &instance->law;
    const double *value = law->value;
    if (t >= value[STUCK_AT]) {
        *early = true;
        *last = t;
        return OK;
    }
    /* With early_parts = n a step takes n calls; the law answers in the last of them, to what the first was asked. */
    if (law->parts == 0) {
        law->begun = t;
        law->whole = step;
    }
    const int left = (int)value[EARLY_PARTS] - law->parts;
    if (left > 1) {
        law->parts++;
        *early = true;
        *last = t + step / left;
        return OK;
    }
    law->parts = 0;
    return instance_step(instance, law->begun, law->whole);
}

EXPORT int fmi3Reset(Instance *instance) {
    return instance_reset(instance);
}

NOTHING(fmi3SetDebugLogging)
NOTHING(fmi3EnterInitializationMode)
NOTHING(fmi3ExitInitializationMode)
NOTHING(fmi3Terminate)
ABSENT(fmi3InstantiateModelExchange)
ABSENT(fmi3InstantiateScheduledExecution)
ABSENT(fmi3EnterEventMode)
ABSENT(fmi3GetFloat32)
ABSENT(fmi3GetInt8)
ABSENT(fmi3GetUInt8)
ABSENT(fmi3GetInt16)
ABSENT(fmi3GetUInt16)
ABSENT(fmi3GetInt32)
ABSENT(fmi3GetUInt32)
ABSENT(fmi3GetInt64)
ABSENT(fmi3GetUInt64)
ABSENT(fmi3GetBoolean)
ABSENT(fmi3GetString)
ABSENT(fmi3GetBinary)
ABSENT(fmi3GetClock)
ABSENT(fmi3SetFloat32)
ABSENT(fmi3SetInt8)
ABSENT(fmi3SetUInt8)
ABSENT(fmi3SetInt16)
ABSENT(fmi3SetUInt16)
ABSENT(fmi3SetInt32)
ABSENT(fmi3SetUInt32)
ABSENT(fmi3SetInt64)
ABSENT(fmi3SetUInt64)
ABSENT(fmi3SetBoolean)
ABSENT(fmi3SetString)
ABSENT(fmi3SetBinary)
ABSENT(fmi3SetClock)
ABSENT(fmi3GetNumberOfVariableDependencies)
ABSENT(fmi3GetVariableDependencies)
ABSENT(fmi3GetFMUState)
ABSENT(fmi3SetFMUState)
ABSENT(fmi3FreeFMUState)
ABSENT(fmi3SerializedFMUStateSize)
ABSENT(fmi3SerializeFMUState)
ABSENT(fmi3DeserializeFMUState)
ABSENT(fmi3GetDirectionalDerivative)
ABSENT(fmi3GetAdjointDerivative)
ABSENT(fmi3EnterConfigurationMode)
ABSENT(fmi3ExitConfigurationMode)
ABSENT(fmi3GetIntervalDecimal)
ABSENT(fmi3GetIntervalFraction)
ABSENT(fmi3GetShiftDecimal)
ABSENT(fmi3GetShiftFraction)
ABSENT(fmi3SetIntervalDecimal)
ABSENT(fmi3SetIntervalFraction)
ABSENT(fmi3SetShiftDecimal)
ABSENT(fmi3SetShiftFraction)
ABSENT(fmi3EvaluateDiscreteStates)
ABSENT(fmi3UpdateDiscreteStates)
ABSENT(fmi3EnterContinuousTimeMode)
ABSENT(fmi3CompletedIntegratorStep)
ABSENT(fmi3SetTime)
ABSENT(fmi3SetContinuousStates)
ABSENT(fmi3GetContinuousStateDerivatives)
ABSENT(fmi3GetEventIndicators)
ABSENT(fmi3GetContinuousStates)
ABSENT(fmi3GetNominalsOfContinuousStates)
ABSENT(fmi3GetNumberOfEventIndicators)
ABSENT(fmi3GetNumberOfContinuousStates)
ABSENT(fmi3EnterStepMode)
ABSENT(fmi3GetOutputDerivatives)
ABSENT(fmi3ActivateModelPartition)
