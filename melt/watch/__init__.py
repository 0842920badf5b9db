"""The watchdog of a run: alarms, the hunt for the stage that is to blame, its capsule, and halved steps."""
