/* The slip law as an FMU of FMI 2.0 for co-simulation. Prototypes as the standard has them (FMI 2.0.4, chapters 2.1 and 4.2). */
#include <stddef.h>

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);

typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

typedef const Callbacks *Caller;

static void tell(Caller caller, int status, const char *message) {
    if (caller != NULL && caller->logger != NULL) {
        caller->logger(caller->environment, "slip", status, "error", message);
    }
}

#include "instance.h"

EXPORT const char *fmi2GetTypesPlatform(void) {
    return "default";
}

EXPORT const char *fmi2GetVersion(void) {
    return "2.0";
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)resources, (void)visible, (void)logging;
    return instance_new(guid, "{slip-law-2}", callbacks);
}

EXPORT void fmi2FreeInstance(void *instance) {
    free(instance);
}

EXPORT int fmi2SetReal(Instance *instance, const unsigned *references, size_t count, const double *values) {
    return law_write(&instance->law, references, count, values);
}

EXPORT int fmi2GetReal(Instance *instance, const unsigned *references, size_t count, double *values) {
    return law_read(&instance->law, references, count, values);
}

EXPORT int fmi2DoStep(Instance *instance, double t, double step, int final) {
    (void)final;
    return instance_step(instance, t, step);
}

EXPORT int fmi2Reset(Instance *instance) {
    return instance_reset(instance);
}

NOTHING(fmi2SetDebugLogging)
NOTHING(fmi2SetupExperiment)
NOTHING(fmi2EnterInitializationMode)
NOTHING(fmi2ExitInitializationMode)
NOTHING(fmi2Terminate)
ABSENT(fmi2GetInteger)
ABSENT(fmi2GetBoolean)
ABSENT(fmi2GetString)
ABSENT(fmi2SetInteger)
ABSENT(fmi2SetBoolean)
ABSENT(fmi2SetString)
ABSENT(fmi2GetFMUstate)
ABSENT(fmi2SetFMUstate)
ABSENT(fmi2FreeFMUstate)
ABSENT(fmi2SerializedFMUstateSize)
ABSENT(fmi2SerializeFMUstate)
ABSENT(fmi2DeSerializeFMUstate)
ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2SetRealInputDerivatives)
ABSENT(fmi2GetRealOutputDerivatives)
ABSENT(fmi2CancelStep)
ABSENT(fmi2GetStatus)
ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetStringStatus)
